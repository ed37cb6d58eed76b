"""Trials that show several motions of one speech, one to a video, in random order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from motion.segment import Segment
from studyapp.study.design.allocation import shuffled
from studyapp.study.design.planned_trial import Kind, PlannedTrial
from studyapp.study.design.stimulus import Stimulus


def grouped_trial(
    kind: Kind,
    part: str,
    segment: Segment,
    conditions: Sequence[str],
    chance: np.random.Generator,
    *,
    reference: str | None = None,
) -> PlannedTrial:
    """Return a trial of `conditions` in random order, still without a position.

    Parameters
    ----------
    kind, part
        As in `PlannedTrial`.
    segment : Segment
        The speech of all motions.
    conditions : sequence of str
        What is judged.
    chance : numpy.random.Generator
        Draws the order.
    reference : str or None
        The condition shown apart and not judged.
    """
    return PlannedTrial(
        position=0,
        kind=kind,
        part=part,
        segment=segment,
        reference=None if reference is None else Stimulus.own(reference, segment.name),
        videos=tuple(
            (Stimulus.own(condition, segment.name),) for condition in shuffled(conditions, chance)
        ),
    )


def grouped_catch_trial(
    part: str,
    segment: Segment,
    conditions: Sequence[str],
    chance: np.random.Generator,
    *,
    right: str,
    flawed: str,
    reference: str | None = None,
) -> PlannedTrial:
    """Return a catch trial as large as a trial of `conditions`: `right`, `flawed`, and others."""
    others = shuffled([name for name in conditions if name != right], chance)
    shown = (right, flawed, *others[: max(0, len(conditions) - 2)])
    trial = grouped_trial("catch", part, segment, shown, chance, reference=reference)
    return replace(trial, expected=1 + trial.conditions.index(right))
