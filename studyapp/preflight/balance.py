"""How evenly the planned trials of a study show sides, segments, conditions and orders."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import permutations
from typing import Final

from studyapp.study.design.planned_trial import PlannedTrial

ANALYSED: Final = ("main", "repeat")

Plans = Sequence[Sequence[PlannedTrial]]
"""The trials of several participants."""


@dataclass(frozen=True, kw_only=True)
class Share:
    """How often something was shown in one way.

    Attributes
    ----------
    what : str
        In words that follow 'how often'.
    times, of : int
    even : float
        What an even share would be.
    """

    what: str
    times: int
    of: int
    even: float

    @property
    def share(self) -> float:
        """Its share of all."""
        return self.times / self.of

    @property
    def off(self) -> float:
        """How far it is from an even share."""
        return abs(self.share - self.even)

    @property
    def deviations(self) -> float:
        """The same in standard deviations of a share that is left to chance."""
        spread = (self.even * (1 - self.even) / self.of) ** 0.5
        return self.off / spread if spread > 0 else 0.0


def analysed(plans: Plans) -> list[PlannedTrial]:
    """Return the trials whose answers are analysed."""
    return [trial for plan in plans for trial in plan if trial.kind in ANALYSED]


def places_of_conditions(plans: Plans) -> Iterator[Share]:
    """Yield how often each condition stands first, of each set of conditions shown together.

    Of two beside each other that is the left side.
    """
    first: Counter[tuple[str, tuple[str, ...], str]] = Counter()
    shown: Counter[tuple[str, tuple[str, ...]]] = Counter()
    for trial in analysed(plans):
        together = tuple(sorted(set(trial.conditions)))
        if len(together) < len(trial.conditions):
            continue
        shown[trial.part, together] += 1
        first[trial.part, together, trial.conditions[0]] += 1
    for (part, together), times in sorted(shown.items()):
        for condition in together:
            beside = " and ".join(other for other in together if other != condition)
            yield Share(
                what=f"{condition!r} stands {'left of' if len(together) == 2 else 'before'} "
                f"{beside}",
                times=first[part, together, condition],
                of=times,
                even=1 / len(together),
            )


def counts_of_segments(plans: Plans, segments: Sequence[str]) -> dict[str, int]:
    """Return how often each segment comes in an analysed trial."""
    times = Counter(trial.segment.name for trial in analysed(plans))
    return {segment: times[segment] for segment in segments}


def counts_of_pairs(plans: Plans) -> dict[str, dict[tuple[str, ...], int]]:
    """Return, for each part, how often each set of conditions is shown together."""
    found: dict[str, Counter[tuple[str, ...]]] = {}
    for trial in analysed(plans):
        together = tuple(sorted(trial.conditions))
        found.setdefault(trial.part, Counter())[together] += 1
    return {part: dict(times) for part, times in found.items()}


def orders_of_pairs(plans: Plans) -> Iterator[Share]:
    """Yield for how many participants one set of conditions comes before another one, on average.

    A condition that always comes first is judged by eyes that are fresh.
    """
    before: Counter[tuple[str, tuple[str, ...], tuple[str, ...]]] = Counter()
    for plan in plans:
        positions: dict[tuple[str, tuple[str, ...]], list[int]] = {}
        for trial in plan:
            if trial.kind in ANALYSED:
                shown = trial.part, tuple(sorted(trial.conditions))
                positions.setdefault(shown, []).append(trial.position)
        mean = {shown: sum(where) / len(where) for shown, where in positions.items()}
        for (part, one), (other_part, other) in permutations(mean, 2):
            if part == other_part and mean[part, one] < mean[part, other]:
                before[part, one, other] += 1
    for part, one, other in sorted({(p, min(a, b), max(a, b)) for p, a, b in before}):
        both = before[part, one, other] + before[part, other, one]
        yield Share(
            what=f"{' and '.join(one)} come before {' and '.join(other)}",
            times=before[part, one, other],
            of=both,
            even=0.5,
        )
