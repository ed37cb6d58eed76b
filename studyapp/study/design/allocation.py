"""The segments of each participant, the order of trials, and the sides of pairs."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, Literal, Self, TypeVar

import numpy as np

from motion.segment import Segment
from studyapp.study.design.trial import Content, Kind, PlannedTrial, Stimulus

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
        quotas = Counter(self.even)
        quotas.update(self.additional(number))
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
        taken.update(shares[count].additional(earlier))
    return taken


def shuffled(items: Sequence[T], chance: np.random.Generator) -> list[T]:
    """Return `items` in random order."""
    return [items[index] for index in chance.permutation(len(items)).tolist()]


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


def draw_sides(count: int, chance: np.random.Generator) -> list[bool]:
    """Return `count` random sides, half of them True; the odd one is random."""
    start = int(chance.integers(2))
    return shuffled([bool((start + index) % 2) for index in range(count)], chance)


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

PREFERENCES: Final[Mapping[int, Sequence[int]]] = {2: (-1, 1), 3: (-1, 0, 1), 5: (-2, -1, 0, 1, 2)}
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

    The first stimulus of a catch trial is the better one.

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
            expected=(1 if first_is_a else 2) if kind == "catch" else None,
        )
        for (segment, a, b), first_is_a in zip(pairs, sides, strict=True)
    ]


def pair_videos(left: Stimulus, right: Stimulus, *, composed: bool) -> tuple[Content, ...]:
    """Return the videos that show two stimuli."""
    return ((left, right),) if composed else ((left,), (right,))
