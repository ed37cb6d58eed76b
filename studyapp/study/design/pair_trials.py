"""Trials that show two stimuli, one way round in half of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from motion.segment import Segment
from studyapp.study.design.order import even_sides
from studyapp.study.design.planned_trial import Kind, PlannedTrial
from studyapp.study.design.stimulus import Content, Stimulus

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
