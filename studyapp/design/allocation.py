"""Which segments a participant sees: even over emotions, and even over participants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np

from motion.segment import Segment

T = TypeVar("T")


def even_quotas(available: Mapping[str, int], total: int, number: int) -> dict[str, int]:
    """Share `total` out over the emotions as evenly as what is available allows.

    Every emotion gets the same, except those with fewer segments, which give all they have.
    What cannot be shared evenly goes to different emotions for consecutive participants.

    Parameters
    ----------
    available : mapping of emotion to int
        How many segments each emotion has.
    total : int
        How many segments are wanted; more than there are means all.
    number : int
        The participant's number within the comparison, from 0.

    Returns
    -------
    dict of emotion to int
        Adding up to ``min(total, sum(available.values()))``.
    """
    total = min(total, sum(available.values()))
    level = 0
    while sum(min(count, level + 1) for count in available.values()) <= total:
        level += 1
        if level >= max(available.values(), default=0):
            break
    quotas = {emotion: min(count, level) for emotion, count in available.items()}
    rest = total - sum(quotas.values())
    larger = [emotion for emotion, count in available.items() if count > level]
    for step in range(rest):
        quotas[larger[(number * rest + step) % len(larger)]] += 1
    return quotas


def allocate_segments(
    segments: Sequence[Segment], total: int, *, number: int, seed: Sequence[int]
) -> tuple[Segment, ...]:
    """Choose the segments of one participant.

    The segments of an emotion form a ring in an order drawn once per study; each participant
    takes the next ones along it. No segment comes again before every other one of its emotion
    has been shown, whoever takes part, so that all are judged equally often.

    Parameters
    ----------
    segments : sequence of Segment
        All segments of the study.
    total : int
        How many to choose, at most.
    number : int
        The participant's number within the comparison, from 0.
    seed : sequence of int
        Seeds the order of the rings; the same for all participants of a comparison.

    Returns
    -------
    tuple of Segment
        Without duplicates, grouped by emotion.
    """
    chance = np.random.default_rng(list(seed))
    rings: dict[str, list[Segment]] = {}
    for segment in shuffled(segments, chance):
        rings.setdefault(segment.emotion, []).append(segment)
    available = {emotion: len(ring) for emotion, ring in rings.items()}
    taken = dict.fromkeys(rings, 0)
    for earlier in range(number):
        for emotion, count in even_quotas(available, total, earlier).items():
            taken[emotion] += count
    return tuple(
        rings[emotion][(taken[emotion] + step) % available[emotion]]
        for emotion, count in even_quotas(available, total, number).items()
        for step in range(count)
    )


def shuffled(items: Sequence[T], chance: np.random.Generator) -> list[T]:
    """Return `items` in random order."""
    return [items[index] for index in chance.permutation(len(items))]
