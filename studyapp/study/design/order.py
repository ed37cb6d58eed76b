"""Putting trials in order: sides of pairs, and extra trials scattered among the others."""

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
    """Return `count` random sides, half of them True; an odd one is either by chance."""
    start = int(chance.integers(2))
    return shuffled([bool((start + index) % 2) for index in range(count)], chance)


def draw_segments(
    segments: Sequence[Segment],
    count: int,
    chance: np.random.Generator,
    *,
    heard: Iterable[Segment] = (),
) -> list[Segment]:
    """Return `count` random segments; one comes twice only when there are too few.

    Those that other trials have are taken last and the least often heard of them first: speech
    that comes again would tell an extra trial from an ordinary one.

    Parameters
    ----------
    heard : iterable of Segment
        The speech of the other trials.
    """
    times = Counter(heard)
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
    """Return `others` in their order with `extra`, in random order, in random gaps between them.

    No two of `extra` follow each other as long as there are gaps enough, and none comes first
    unless `may_lead`.
    """
    gaps = np.arange(0 if may_lead else 1, len(others) + 1)
    enough = len(gaps) >= len(extra)
    before = sorted(chance.choice(gaps, size=len(extra), replace=not enough).tolist())
    merged = list(others)
    for gap, trial in sorted(
        zip(before, shuffled(extra, chance), strict=True), key=lambda at: at[0], reverse=True
    ):
        merged.insert(gap, trial)
    return merged


def scatter_by_part(
    extra: Sequence[PlannedTrial], others: Sequence[PlannedTrial], chance: np.random.Generator
) -> list[PlannedTrial]:
    """Return `others` in their order with each of `extra` somewhere in its own part.

    What belongs to another part can look otherwise, which would tell that it is extra. None of
    `extra` comes first of all.
    """
    merged: list[PlannedTrial] = []
    for part in dict.fromkeys(trial.part for trial in others):
        own, more = ([t for t in trials if t.part == part] for trials in (others, extra))
        merged += scatter(more, own, chance, may_lead=bool(merged))
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
"""By how many answers there are: below 0 for the first stimulus (A), above for the second (B)."""

StimulusPair = tuple[Segment, Stimulus, Stimulus]
"""What a trial is about, and the two stimuli that it shows."""


def pair_trials(
    kind: Kind,
    shown: Sequence[StimulusPair],
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
    sides = draw_sides(len(shown), chance)
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


def prefers_side(answers: Answers, number: int) -> bool:
    """Tell whether every answer prefers stimulus `number`, which is 1 or 2, however little."""
    return all((value > 0) if number == 2 else (value < 0) for value in answers.values())
