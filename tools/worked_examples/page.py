"""The page of worked examples: what published numbers and rules do and do not support.

``python -m tools.worked_examples.page FILE`` writes them.
"""

import argparse
from pathlib import Path
from typing import Any, Final

from scipy import stats

from analysis.report import wording
from motion.files import write_text
from tools.markdown import rendered
from tools.worked_examples import amuse_study, s2ue_study
from tools.worked_examples.rebuilt import (
    LEVEL,
    SPREADS,
    Rebuilt,
    counts_behind,
    printable_neighbours,
    rebuild,
    supported,
)
from tools.worked_examples.spread import SharedAnswers, Spread

_FAILING: Final = (0.02, 0.05, 0.10)
"""Probabilities that an attentive participant fails a catch trial."""

_GUESSING: Final = 1 - (2 / 5) ** 2
"""Probability for random answers to two questions of five levels, two of which are right."""


def worked_examples() -> str:
    """Return the page of worked examples in Markdown."""
    return rendered("tools.worked_examples", "worked_examples.md", **_facts())


def _facts() -> dict[str, Any]:
    rebuilt = rebuild()
    return {
        "recruited": amuse_study.RECRUITED,
        "pairs": amuse_study.PAIRS,
        "tests": len(rebuilt),
        "rows": [_row(row) for row in rebuilt],
        "insignificant": _insignificant(rebuilt),
        "spreads": [_spread(spread) for spread in SPREADS],
        "typical_effects": _effects(rebuilt, SPREADS[2]),
        "large_effects": _effects(rebuilt, SPREADS[3]),
        "claims": [_claim(claim, rebuilt) for claim in amuse_study.CLAIMS],
        "catch_trials": amuse_study.CATCH_TRIALS,
        "attentive": [_excluded(failing) for failing in _FAILING],
        "guessing": _excluded(_GUESSING),
        "left_out": {
            row.other: amuse_study.RECRUITED - row.participants for row in amuse_study.TABLE_A5
        },
        "participants": s2ue_study.PARTICIPANTS,
        "ratings": s2ue_study.PARTICIPANTS * s2ue_study.GROUPS,
        "percentages": [_percentage(printed) for printed in s2ue_study.PERCENTAGES],
    }


def _row(row: Rebuilt) -> dict[str, Any]:
    printed = row.printed
    ours, others = row.nearest
    low, high = (wording.p_value(p) for p in row.binomial_range)
    return {
        "criterion": wording.heading(printed.criterion),
        "other": printed.other,
        "participants": printed.participants,
        "answers": printed.answers,
        "ours_percent": printed.ours,
        "others_percent": printed.others,
        "ours": f"{ours} ({row.ours[0]} to {row.ours[-1]})",
        "others": f"{others} ({row.others[0]} to {row.others[-1]})",
        "equal": printed.answers - ours - others,
        "win_share": wording.share(printed.win_share),
        "binomial_p": wording.p_value(row.binomial_p),
        "binomial_range": low if low == high else f"{low} to {high}",
        "binomial_holm": wording.p_value(row.binomial_holm),
        "wilcoxon_p": wording.p_value(row.wilcoxon_p),
        "shared": [
            f"{_interval(shared)}, {wording.p_value(corrected)}"
            for shared, corrected in zip(row.shared, row.shared_holm, strict=True)
        ],
    }


def _insignificant(rebuilt: tuple[Rebuilt, ...]) -> list[str]:
    """Return the rows that are not significant even with the largest possible counts."""
    return [
        f"{row.printed.other} in {row.printed.criterion} (p = {wording.p_value(row.binomial_p)})"
        for row in rebuilt
        if row.binomial_range[0] >= LEVEL
    ]


def _spread(spread: Spread) -> str:
    return f"{wording.share(spread.participants)} / {wording.share(spread.items)}"


def _effects(rebuilt: tuple[Rebuilt, ...], spread: Spread) -> str:
    """Return the range of design effects, '3.3 to 3.8'."""
    place = SPREADS.index(spread)
    effects = [row.shared[place].design_effect for row in rebuilt]
    return f"{min(effects):.1f} to {max(effects):.1f}"


def _interval(shared: SharedAnswers) -> str:
    return f"[{wording.share(shared.low)}, {wording.share(shared.high)}]"


def _claim(claim: amuse_study.Claim, rebuilt: tuple[Rebuilt, ...]) -> dict[str, Any]:
    found = supported(claim, rebuilt)
    counts = (found.naive, *found.shared)
    return {
        "quote": claim.quote,
        "place": claim.place,
        "criterion": claim.criterion,
        "counts": [f"{count} of {found.tests}" for count in counts],
        "verdict": _verdict(counts, found.tests),
    }


def _verdict(counts: tuple[int, ...], tests: int) -> str:
    """Return the verdict on a claim under successively stricter analyses."""
    if min(counts) == tests:
        return "stands"
    if counts[0] < tests:
        return "was never supported as a whole" if tests > 1 else "was never supported"
    return "stands only where participants and segments hardly differ"


def _excluded(failing: float) -> dict[str, str]:
    """Return the probability, in percent, that a participant is excluded by each rule.

    `failing` is the probability of failing one catch trial, independently of the others.
    """
    failures = stats.binom(amuse_study.CATCH_TRIALS, failing)
    return {
        "failing": wording.percent(100 * failing),
        "more_than_one": f"{100 * failures.sf(1):.1f}",
        "any": f"{100 * failures.sf(0):.1f}",
        "all": f"{100 * failures.pmf(amuse_study.CATCH_TRIALS):.1f}",
    }


def _percentage(printed: s2ue_study.PrintedPercentage) -> dict[str, str]:
    people, ratings = s2ue_study.PARTICIPANTS, s2ue_study.PARTICIPANTS * s2ue_study.GROUPS
    return {
        "printed": f"{printed.percent:.2f}",
        "question": printed.question,
        "set": str(printed.set_number),
        "people": _possible(printed.percent, people),
        "ratings": _possible(printed.percent, ratings),
    }


def _possible(percent: float, total: int) -> str:
    """Return the count behind a percentage, or the nearest percentages if there is none."""
    counts = counts_behind(percent, total, s2ue_study.DECIMALS)
    if counts:
        return f"{counts[0]} of {total}"
    low, high = printable_neighbours(percent, total, s2ue_study.DECIMALS)
    return f"impossible: {low:.2f} or {high:.2f}"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, help="such as docs/worked-examples.md")
    write_text(parser.parse_args().file, worked_examples())
