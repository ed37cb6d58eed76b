"""Counts reconstructed from printed percentages (AMUSE's Table A.5), and their tests."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from analysis.stats.multiple_testing import holm
from analysis.stats.one_sample_tests import pooled_tests, sign_test
from tools.worked_examples.amuse_study import PAIRS, TABLE_A5, Claim, PrintedPreference
from tools.worked_examples.spread import SharedAnswers, Spread, with_spread

_ROUNDING: Final = 1e-9
"""Tolerance: a share halfway between two printed ones may have been rounded either way."""

SPREADS: Final = (
    Spread(participants=0.0, items=0.0),
    Spread(participants=0.6, items=0.0),
    Spread(participants=0.6, items=0.45),
    Spread(participants=1.0, items=0.8),
)
"""Spreads from none at all to large ones."""

LEVEL: Final = 0.05


def counts_behind(percent: float, total: int, decimals: int = 0) -> range:
    """Return every count out of `total` that is printed as `percent`.

    Parameters
    ----------
    percent : float
        The printed percentage, 0 to 100.
    total : int
        The total that it refers to, at least 1.
    decimals : int
        Digits printed after the point.

    Returns
    -------
    range
        Empty if the percentage is impossible.
    """
    half = 0.5 * 10.0**-decimals + _ROUNDING
    low = max(math.ceil((percent - half) * total / 100), 0)
    high = min(math.floor((percent + half) * total / 100), total)
    return range(low, high + 1)


def printable_neighbours(percent: float, total: int, decimals: int = 0) -> tuple[float, float]:
    """Return the percentages of `total` next below and next above `percent`, as printed."""
    below = math.floor(percent * total / 100)
    low, high = (round(100 * count / total, decimals) for count in (below, below + 1))
    return low, high


@dataclass(frozen=True, kw_only=True)
class Rebuilt:
    """One row and criterion as counts, with their tests.

    Attributes
    ----------
    printed : PrintedPreference
        The percentages.
    ours, others : range
        All counts that are printed as the percentage.
    binomial_p : float
        Sign test of the counts nearest to the percentages.
    binomial_range : tuple of (float, float)
        Its smallest and largest p over all counts in `ours` and `others`.
    wilcoxon_p : float
        Signed-rank test of the nearest counts, assuming that half of each side's preferences are
        strong, which is not printed.
    binomial_holm : float
        `binomial_p` corrected over the whole table.
    shared : tuple of SharedAnswers
        Results under each of `SPREADS`.
    shared_holm : tuple of float
        The p of each, corrected over the whole table.
    """

    printed: PrintedPreference
    ours: range
    others: range
    binomial_p: float
    binomial_range: tuple[float, float]
    wilcoxon_p: float
    binomial_holm: float
    shared: tuple[SharedAnswers, ...]
    shared_holm: tuple[float, ...]

    @property
    def nearest(self) -> tuple[int, int]:
        """Counts nearest to the percentages of preferences for AMUSE and for the other."""
        return _nearest(self.printed)


@dataclass(frozen=True, kw_only=True)
class Supported:
    """How much of a claim the table supports.

    Attributes
    ----------
    claim : Claim
        The sentence.
    tests : int
        Number of comparisons that it rests on.
    naive : int
        Number supported by the corrected sign test of pooled answers.
    shared : tuple of int
        Number supported under each of `SPREADS`, corrected.
    """

    claim: Claim
    tests: int
    naive: int
    shared: tuple[int, ...]


def rebuild() -> tuple[Rebuilt, ...]:
    """Rebuild every row and criterion of Table A.5; together they are one family of tests."""
    naive = [_pooled(*_nearest(row), row.answers) for row in TABLE_A5]
    naive_holm = holm([p for p, _ in naive])
    shared = [[_shared(row, spread) for spread in SPREADS] for row in TABLE_A5]
    by_spread = [holm([row[place].p_value for row in shared]) for place in range(len(SPREADS))]
    rebuilt = []
    for place, row in enumerate(TABLE_A5):
        ours, others = (counts_behind(p, row.answers) for p in (row.ours, row.others))
        possible = [_sign_p(first, second) for first in ours for second in others]
        rebuilt.append(
            Rebuilt(
                printed=row,
                ours=ours,
                others=others,
                binomial_p=naive[place][0],
                binomial_range=(min(possible), max(possible)),
                wilcoxon_p=naive[place][1],
                binomial_holm=naive_holm[place],
                shared=tuple(shared[place]),
                shared_holm=tuple(corrected[place] for corrected in by_spread),
            )
        )
    return tuple(rebuilt)


def supported(claim: Claim, rebuilt: tuple[Rebuilt, ...]) -> Supported:
    """Count the parts of `claim` that are significant in the claimed direction."""
    rows = [
        row
        for row in rebuilt
        if claim.rests_on(row.printed) and (row.printed.win_share > 0.5) == claim.amuse_wins
    ]
    return Supported(
        claim=claim,
        tests=sum(claim.rests_on(row.printed) for row in rebuilt),
        naive=sum(row.binomial_holm < LEVEL for row in rows),
        shared=tuple(
            sum(row.shared_holm[place] < LEVEL for row in rows) for place in range(len(SPREADS))
        ),
    )


def _nearest(row: PrintedPreference) -> tuple[int, int]:
    ours, others = (round(percent * row.answers / 100) for percent in (row.ours, row.others))
    return ours, others


def _pooled(ours: int, others: int, answers: int) -> tuple[float, float]:
    """Return p of the sign test and of Wilcoxon's, with half of each side's preferences strong."""
    sizes = (2, 1, 0, -1, -2)
    strong, also_strong = ours // 2, others // 2
    counts = (
        strong, ours - strong, answers - ours - others, others - also_strong, also_strong,
    )  # fmt: skip
    tests = pooled_tests(np.repeat(np.array(sizes), counts))
    return tests.binomial_p, tests.wilcoxon_p


def _sign_p(ours: int, others: int) -> float:
    return sign_test(np.repeat([1.0, -1.0], [ours, others])).p_value


def _shared(row: PrintedPreference, spread: Spread) -> SharedAnswers:
    return with_spread(
        row.ours / 100,
        row.others / 100,
        participants=row.participants,
        items=PAIRS,
        spread=spread,
    )
