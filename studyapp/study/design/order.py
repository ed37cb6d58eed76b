"""The order of trials: sides of pairs, and catch trials and attention checks among the others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Final, Literal

import numpy as np

from motion.segment import Segment
from studyapp.study.design.allocation import shuffled
from studyapp.study.design.trial import Answers, Content, Kind, PlannedTrial, Stimulus


def draw_sides(count: int, chance: np.random.Generator) -> list[bool]:
    """Return `count` random sides, half of them True; the odd one is random."""
    start = int(chance.integers(2))
    return shuffled([bool((start + index) % 2) for index in range(count)], chance)


def draw_segments(
    segments: Sequence[Segment],
    count: int,
    chance: np.random.Generator,
    *,
    used: Iterable[Segment] = (),
) -> list[Segment]:
    """Return `count` random segments; one is repeated only if there are too few.

    Segments of other trials are drawn last, the rarest first: repeated speech would tell an extra
    trial from an ordinary one.

    Parameters
    ----------
    used : iterable of Segment
        The segments of the other trials.
    """
    times = Counter(used)
    drawn: list[Segment] = []
    while segments and len(drawn) < count:
        drawn.extend(sorted(shuffled(segments, chance), key=times.__getitem__))
    return drawn[:count]


def scatter(
    extra: Sequence[PlannedTrial],
    others: Sequence[PlannedTrial],
    chance: np.random.Generator,
    *,
    may_lead: bool,
) -> list[PlannedTrial]:
    """Insert `extra`, shuffled, into random gaps of `others`.

    No two of `extra` are adjacent if there are enough gaps, and none comes first unless
    `may_lead`.
    """
    gaps = np.arange(0 if may_lead else 1, len(others) + 1)
    too_few = len(gaps) < len(extra)
    positions = sorted(chance.choice(gaps, size=len(extra), replace=too_few).tolist())
    merged = list(others)
    for offset, (gap, trial) in enumerate(zip(positions, shuffled(extra, chance), strict=True)):
        merged.insert(gap + offset, trial)
    return merged


def scatter_by_part(
    extra: Sequence[PlannedTrial], others: Sequence[PlannedTrial], chance: np.random.Generator
) -> list[PlannedTrial]:
    """Insert each of `extra` into its own part of `others`, but never before all of them.

    A trial can look different from those of another part, which would give it away.
    """
    merged: list[PlannedTrial] = []
    for part in dict.fromkeys(trial.part for trial in others):
        of_part, inserted = ([t for t in trials if t.part == part] for trials in (others, extra))
        merged += scatter(inserted, of_part, chance, may_lead=bool(merged))
    return merged


def number_trials(trials: Iterable[PlannedTrial]) -> tuple[PlannedTrial, ...]:
    """Return `trials` with their positions, from 1."""
    return tuple(
        replace(trial, position=position) for position, trial in enumerate(trials, start=1)
    )


Levels = Literal[2, 3, 5]

PREFERENCES: Final[Mapping[int, Sequence[int]]] = MappingProxyType(
    {2: (-1, 1), 3: (-1, 0, 1), 5: (-2, -1, 0, 1, 2)}
)
"""The answers, by their number: below 0 for the first stimulus (A), above 0 for the second (B)."""

StimulusPair = tuple[Segment, Stimulus, Stimulus]
"""A segment, and two stimuli of one trial about it."""


def pair_trials(
    kind: Kind,
    pairs: Sequence[StimulusPair],
    chance: np.random.Generator,
    *,
    composed: bool,
    part: str = "",
) -> list[PlannedTrial]:
    """Return a trial for each pair; in half of them, the first stimulus is A.

    Parameters
    ----------
    composed : bool
        Whether one video shows both stimuli.
    """
    sides = draw_sides(len(pairs), chance)
    return [
        PlannedTrial(
            position=0,
            kind=kind,
            part=part,
            segment=segment,
            videos=pair_videos(*((a, b) if first_is_a else (b, a)), composed=composed),
        )
        for (segment, a, b), first_is_a in zip(pairs, sides, strict=True)
    ]


def pair_videos(left: Stimulus, right: Stimulus, *, composed: bool) -> tuple[Content, ...]:
    """Return the videos that show two stimuli."""
    return ((left, right),) if composed else ((left,), (right,))


def prefers_side(answers: Answers, number: int) -> bool:
    """Tell whether every answer prefers stimulus `number` (1 or 2), however slightly."""
    return all((value > 0) if number == 2 else (value < 0) for value in answers.values())
