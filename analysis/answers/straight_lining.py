"""Straight-lining: participants who give the same answer again and again."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd


@dataclass(frozen=True, kw_only=True)
class StraightLine:
    """How alike one participant's answers are.

    Attributes
    ----------
    participant : str
        Whose.
    answers : int
        How many were given.
    share : float
        Of the most frequent one, in (0, 1].
    """

    participant: str
    answers: int
    share: float


def straight_lining(answers: pd.DataFrame) -> tuple[StraightLine, ...]:
    """Measure how alike each participant's answers are, in the order of appearance.

    Parameters
    ----------
    answers : DataFrame
        Columns `participant` and `value`, as it was chosen on the page (the side, not the
        condition).
    """
    times = answers.groupby(["participant", "value"], sort=False, observed=True).size()
    each = times.groupby(level=0, sort=False, observed=True)
    return tuple(
        StraightLine(participant=str(name), answers=int(total), share=float(most / total))
        for (name, total), most in zip(each.sum().items(), each.max(), strict=True)
    )
