"""The segments of each participant."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Self, TypeVar

import numpy as np

from motion.segment import Segment

T = TypeVar("T")


def even_quotas(available: Mapping[str, int], total: int, number: int) -> dict[str, int]:
    """Divide `total` segments among the emotions as evenly as `available` allows.

    Every emotion gets the same, except those with too few segments, which give all they have. The
    remainder goes to different emotions for consecutive participants.

    Parameters
    ----------
    available : mapping of emotion to int
        Number of segments.
    total : int
        At most all segments are used.
    number : int
        The participant's number within the comparison, from 0.

    Returns
    -------
    dict of emotion to int
        Adding up to ``min(total, sum(available.values()))``.
    """
    return _Share.of(available, total).quotas(number)


@dataclass(frozen=True)
class _Share:
    """An even share of each emotion, and a `remainder` that rotates among the larger emotions."""

    even: Mapping[str, int]
    larger: Sequence[str]
    remainder: int

    @classmethod
    def of(cls, available: Mapping[str, int], total: int) -> Self:
        total = min(total, sum(available.values()))
        level = 0
        while sum(min(count, level + 1) for count in available.values()) <= total:
            level += 1
            if level >= max(available.values(), default=0):
                break
        even = {emotion: min(count, level) for emotion, count in available.items()}
        larger = [emotion for emotion, count in available.items() if count > level]
        return cls(even, larger, total - sum(even.values()))

    def additional(self, number: int) -> Sequence[str]:
        """Return the emotions of which this participant gets one more."""
        first = number * self.remainder
        return [self.larger[(first + step) % len(self.larger)] for step in range(self.remainder)]

    def taken_before(self, number: int) -> dict[str, int]:
        """Return how many segments of each emotion the participants before `number` got."""
        rounds, first = divmod(number * self.remainder, max(1, len(self.larger)))
        taken = {emotion: number * count for emotion, count in self.even.items()}
        for index, emotion in enumerate(self.larger):
            taken[emotion] += rounds + (index < first)
        return taken

    def quotas(self, number: int) -> dict[str, int]:
        quotas = dict(self.even)
        for emotion in self.additional(number):
            quotas[emotion] += 1
        return quotas


def allocate_segments(
    segments: Sequence[Segment],
    total: int,
    *,
    number: int,
    seed: Sequence[int],
    before: Sequence[int] | None = None,
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
    before : sequence of int, optional
        How many each earlier participant got, where that was not always `total`.

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
    share = _Share.of(available, total)
    taken = share.taken_before(number) if before is None else _count_taken(available, before)
    return tuple(
        rings[emotion][(taken[emotion] + step) % available[emotion]]
        for emotion, count in share.quotas(number).items()
        for step in range(count)
    )


def _count_taken(available: Mapping[str, int], before: Sequence[int]) -> Mapping[str, int]:
    """Return how many segments of each emotion the participants with totals `before` got."""
    shares = {count: _Share.of(available, count) for count in set(before)}
    taken = Counter(dict.fromkeys(available, 0))
    for count, times in Counter(before).items():
        for emotion, even in shares[count].even.items():
            taken[emotion] += times * even
    for earlier, count in enumerate(before):
        for emotion in shares[count].additional(earlier):
            taken[emotion] += 1
    return taken


def shuffled(items: Sequence[T], chance: np.random.Generator) -> list[T]:
    """Return `items` in random order."""
    return [items[index] for index in chance.permutation(len(items))]
