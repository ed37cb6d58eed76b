"""Putting trials in order: sides, and extra trials scattered among the others."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from motion.segment import Segment
from studyapp.study.design.allocation import shuffled
from studyapp.study.design.planned_trial import PlannedTrial


def even_sides(count: int, chance: np.random.Generator) -> list[bool]:
    """Return `count` random sides, half of them True; an odd one is either by chance."""
    start = int(chance.integers(2))
    return shuffled([bool((start + index) % 2) for index in range(count)], chance)


def drawn_segments(
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


def scattered(
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


def scattered_by_part(
    extra: Sequence[PlannedTrial], others: Sequence[PlannedTrial], chance: np.random.Generator
) -> list[PlannedTrial]:
    """Return `others` in their order with each of `extra` somewhere in its own part.

    What belongs to another part can look otherwise, which would tell that it is extra. None of
    `extra` comes first of all.
    """
    merged: list[PlannedTrial] = []
    for part in dict.fromkeys(trial.part for trial in others):
        own, more = ([t for t in trials if t.part == part] for trials in (others, extra))
        merged += scattered(more, own, chance, may_lead=bool(merged))
    return merged


def numbered(trials: Iterable[PlannedTrial]) -> tuple[PlannedTrial, ...]:
    """Return `trials` with their positions, from 1."""
    return tuple(
        replace(trial, position=position) for position, trial in enumerate(trials, start=1)
    )
