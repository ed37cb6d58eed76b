"""Trials that show two stimuli, one way round in half of them, and preferences between these."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from motion.segment import Segment
from studyapp.study.design.asking import Answers
from studyapp.study.design.order import even_sides
from studyapp.study.design.planned_trial import Kind, PlannedTrial
from studyapp.study.design.stimulus import Content, Stimulus

Levels = Literal[2, 3, 5]

PREFERENCES: Final[Mapping[int, Sequence[int]]] = MappingProxyType(
    {2: (-1, 1), 3: (-1, 0, 1), 5: (-2, -1, 0, 1, 2)}
)
"""By how many answers there are: below 0 for the first stimulus (A), above for the second (B)."""

Shown = tuple[Segment, Stimulus, Stimulus]
"""What a trial is about, and the two stimuli that it shows."""


def pair_trials(
    kind: Kind,
    shown: Sequence[Shown],
    chance: np.random.Generator,
    *,
    composed: bool,
    part: str = "",
) -> list[PlannedTrial]:
    """Return a trial for each of `shown`, the first stimulus as A in half of them.

    Parameters
    ----------
    composed : bool
        Whether both stimuli are in one video, or each in one of its own.
    """
    sides = even_sides(len(shown), chance)
    return [
        PlannedTrial(
            position=0,
            kind=kind,
            part=part,
            segment=segment,
            videos=pair_videos(*((a, b) if first_is_a else (b, a)), composed=composed),
        )
        for (segment, a, b), first_is_a in zip(shown, sides, strict=True)
    ]


def pair_videos(left: Stimulus, right: Stimulus, *, composed: bool) -> tuple[Content, ...]:
    """Return the videos that show two stimuli."""
    return ((left, right),) if composed else ((left,), (right,))


def prefer_side(answers: Answers, number: int) -> bool:
    """Tell whether every answer prefers stimulus `number`, which is 1 or 2, however little."""
    return all((value > 0) if number == 2 else (value < 0) for value in answers.values())
