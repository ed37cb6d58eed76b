"""Bradley-Terry strengths compared with choix, and our bootstrap with a gather by index."""

import importlib.util
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import Final, TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from analysis.results.resamples import Tallies, resample_preferences
from analysis.stats.strength_models import Votes, bradley_terry

Found = TypeVar("Found")

CONDITIONS: Final = 10
PARTICIPANTS: Final = 1000

Floats = NDArray[np.float64]


def timed(work: Callable[[], Found], *, turns: int = 1) -> tuple[Found, float]:
    """Return what `work` returns, and its processor time in seconds.

    The fastest of `turns` (at least 1) counts: other work of a machine only adds time.
    """
    least = float("inf")
    for _ in range(turns):
        began = time.process_time()
        result = work()
        least = min(least, time.process_time() - began)
    return result, least


@dataclass(frozen=True, kw_only=True)
class BesideChoix:
    """Comparison of the same strengths with choix.

    Attributes
    ----------
    seconds, seconds_choix : float
        Processor time of each; ours includes clustered errors, which choix lacks.
    strengths_apart : float
        Largest difference between log strengths.
    """

    seconds: float
    seconds_choix: float
    strengths_apart: float

    @property
    def times_faster(self) -> float:
        """Choix's time over ours."""
        return self.seconds_choix / self.seconds


def why_not_choix() -> str:
    """Return why choix cannot be used, or an empty text."""
    return "" if importlib.util.find_spec("choix") else "choix is not installed"


def made_votes(count: int) -> Votes:
    """Return votes without ties, which choix does not support."""
    chance = np.random.default_rng(0)
    strengths = chance.normal(0, 0.7, CONDITIONS)
    left = chance.integers(CONDITIONS, size=count)
    right = (left + chance.integers(1, CONDITIONS, size=count)) % CONDITIONS
    won = chance.logistic(size=count) < strengths[left] - strengths[right]
    return Votes(
        conditions=tuple("abcdefghij"),
        left=left.astype(np.intp),
        right=right.astype(np.intp),
        outcome=np.where(won, 1, -1).astype(np.intp),
        participant=chance.integers(PARTICIPANTS, size=count).astype(np.intp),
        segment=np.zeros(count, np.intp),
    )


def beside_choix(votes: Votes, *, turns: int = 5) -> BesideChoix:
    """Compute the strengths of `votes` here and with choix."""
    # A copy each time, because votes cache their counts.
    ours, seconds = timed(lambda: bradley_terry(replace(votes), left_effect=False), turns=turns)
    won = votes.outcome > 0
    pairs = np.column_stack(
        [np.where(won, votes.left, votes.right), np.where(won, votes.right, votes.left)]
    ).tolist()
    choix = import_module("choix")
    theirs, theirs_seconds = timed(lambda: choix.ilsr_pairwise(CONDITIONS, pairs))
    return BesideChoix(
        seconds=seconds,
        seconds_choix=theirs_seconds,
        strengths_apart=float(np.abs(theirs - np.mean(theirs) - ours.strengths).max()),
    )


@dataclass(frozen=True, kw_only=True)
class BesideGather:
    """Comparison of the same bootstrap with a gather.

    Attributes
    ----------
    seconds, seconds_gather : float
        Processor time of each.
    deviations_apart : float
        Relative difference of their means' standard deviations; it falls with more resamples.
    """

    seconds: float
    seconds_gather: float
    deviations_apart: float

    @property
    def times_faster(self) -> float:
        """The gather's time over ours."""
        return self.seconds_gather / self.seconds


def by_gather(table: Floats, resamples: int) -> Floats:
    """Return means of drawn rows and columns of `table`, gathered resample by resample."""
    chance = np.random.default_rng(0)
    rows, columns = table.shape
    return np.array(
        [
            table[np.ix_(chance.integers(rows, size=rows), chance.integers(columns, size=columns))]
            .mean()
            for _ in range(resamples)
        ]
    )  # fmt: skip


def beside_gather(
    participants: int, items: int, *, resamples: int = 10_000, turns: int = 3
) -> BesideGather:
    """Resample a study in which every participant answered about every item."""
    chance = np.random.default_rng(0)
    table = chance.normal(0, 0.6, (participants, 1)) + chance.normal(0, 0.45, items)
    table = table + chance.normal(size=table.shape)
    answers = Tallies(
        conditions=("ours",),
        segments=tuple(map(str, range(items))),
        groups=np.zeros((1, 1), np.intp),
        sums=sparse.csr_array(table),
        counts=sparse.csr_array(np.ones_like(table)),
    )

    def ours() -> Floats:
        return resample_preferences(answers, resamples=resamples, seed=0).draws[:, 0]

    means, seconds = timed(ours, turns=turns)
    gathered, seconds_gather = timed(partial(by_gather, table, resamples))
    return BesideGather(
        seconds=seconds,
        seconds_gather=seconds_gather,
        deviations_apart=abs(float(means.std() / gathered.std()) - 1),
    )
