"""Looks at results before the answers were complete."""

from analysis.stats.multiple_testing import Look


def looked(finished: int, reason: str = "a video broke") -> Look:
    """Return a researcher's look at the answers of `finished` participants, ten of each."""
    return Look(
        day="2026-05-04",
        by="researcher 1",
        way="page",
        reason=reason,
        finished=finished,
        planned=30,
        answers=10 * finished,
    )
