"""What the design shows participants, whom it leaves out, and whether it is balanced."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations
from types import MappingProxyType
from typing import Final

from motion.errors import listed
from motion.segment import EMOTIONS
from studyapp.preflight.finding import Finding, finding
from studyapp.preflight.material import MOST_PLACES, Material
from studyapp.results.analysed_tasks import study_notes
from studyapp.study.design.trial import Kind, PlannedTrial
from studyapp.study.settings.exclusions import Coverage
from studyapp.study.settings.study import Study

KIND_WORDS: Final[Mapping[Kind, str]] = MappingProxyType(
    {
        "practice": "practice (discarded)",
        "main": "main",
        "repeat": "practice ones again (analysed)",
        "catch": "catch",
        "attention": "attention",
    }
)


def design_findings(material: Material) -> Iterator[Finding]:
    """Say what a participant sees, and what the design cannot tell."""
    study, segments = material.study, material.segments
    if not study.open:
        yield finding("closed")
    plan = next(material.plans, ())
    counts = Counter(trial.kind for trial in plan)
    said = ", ".join(
        f"{counts[kind]} {words}" for kind, words in KIND_WORDS.items() if counts[kind]
    )
    if not (counts["main"] or counts["practice"]):
        yield finding("no-trials", segments=len(segments))
        return
    yield finding("trials", count=len(plan), kinds=said)
    yield from _extra_findings(plan)
    for sentence in (*study.notes(segments), *study_notes(study)):
        yield finding("design", sentence.rstrip("."))
    emotions = {segment.emotion for segment in segments}
    silent = [emotion for emotion in EMOTIONS if emotion not in emotions]
    if silent and any("{emotion}" in question.text for question in study.questions):
        yield finding("emotions-missing", emotions=listed(silent))
    yield from _check_findings(study)
    yield from _exclusion_findings(study)


def _check_findings(study: Study) -> Iterator[Finding]:
    """Say whether inattentive participants can be told apart."""
    if not study.catch.trials and not study.attention.trials:
        yield finding("no-checks")
    elif not study.catch.trials:
        yield finding("no-catch-trials")
    for key, checks, words in (
        ("catch", study.catch, "catch trials"),
        ("attention", study.attention, "attention checks"),
    ):
        if 0 < checks.trials <= checks.max_failed and study.exclusions is None:
            yield finding("checks-few", where=f"{key}.max_failed", checks=checks, words=words)


def _exclusion_findings(study: Study) -> Iterator[Finding]:
    """Say who will be left out of the analysis, and which rule can have no effect."""
    rules = study.settled_exclusions
    said = "; ".join(
        f"{place}. who {rule.made().description} ({rule.written()})"
        for place, rule in enumerate(rules, start=1)
    )
    yield finding("exclusions", rules=said or "nobody")
    for rule in rules:
        if isinstance(rule, Coverage) and rule.below <= study.watching.coverage:
            yield finding(
                "exclusion-without-effect",
                rule=rule.written(),
                coverage=study.watching.coverage,
            )


def _extra_findings(plan: Sequence[PlannedTrial]) -> Iterator[Finding]:
    """Say how many extra trials have speech that comes in another trial as well."""
    extra = [trial.segment for trial in plan if trial.kind in ("catch", "attention")]
    times = Counter(trial.segment for trial in plan)
    again = sum(times[segment] > 1 for segment in extra)
    if again:
        yield finding("speech-repeated", again=again, extra=len(extra))


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


SHARE_OFF: Final = 0.05
"""How far a share may be from an even one."""

BEYOND_CHANCE: Final = 3.5
"""Standard deviations from which a share is no chance, of the dozens that are looked at."""

TIMES: Final = 1.5
"""How many times as often as another one something may be shown."""


def balance_findings(material: Material) -> Iterator[Finding]:
    """Count what the planned participants will see, and say where that is uneven."""
    planned = material.planned
    if not any(plan for _, plans in planned for plan in plans):
        return
    if material.study.follows_votes:
        yield finding(
            "balance",
            "pairs are chosen as answers come, so that what participants will see cannot be "
            "counted beforehand",
        )
        return
    places: list[Share] = []
    orders: list[Share] = []
    for _, plans in planned:
        places += places_of_conditions(plans)
        orders += orders_of_pairs(plans)
    together = [plan for _, plans in planned for plan in plans]
    segments = counts_of_segments(together, list(material.by_name))
    yield finding("balance", _balance(material, places, segments))
    yield from _share_findings(places, orders)
    yield from _count_findings(material, segments)


def _balance(material: Material, places: list[Share], segments: dict[str, int]) -> str:
    participants = sum(len(plans) for _, plans in material.planned)
    most = max(arm.places for arm in material.study.arms)
    of = f" (the first {MOST_PLACES} of each arm)" if most > MOST_PLACES else ""
    used = [times for times in segments.values() if times]
    said = f"{participants} planned participants{of} judge each segment {_between(used)} times"
    if places:
        off = max(places, key=lambda share: share.off)
        said += (
            f"; {off.what} in {off.share:.0%} of {off.of} trials, which is farthest from an even "
            f"{off.even:.0%}"
        )
    return said


def _share_findings(places: Iterable[Share], orders: Iterable[Share]) -> Iterator[Finding]:
    for name, shares in (("sides-uneven", places), ("orders-uneven", orders)):
        for share in shares:
            if share.off > SHARE_OFF and share.deviations > BEYOND_CHANCE:
                yield finding(name, shown=share)


def _count_findings(material: Material, segments: dict[str, int]) -> Iterator[Finding]:
    unused = [name for name, times in segments.items() if not times]
    if unused:
        yield finding("segments-unused", segments=_some(unused))
    used = {name: times for name, times in segments.items() if times}
    if _uneven(used.values()):
        least, most = (pick(used, key=used.__getitem__) for pick in (min, max))
        yield finding(
            "segments-uneven", most=most, often=used[most], least=least, rarely=used[least]
        )
    for arm, plans in material.planned:
        for part, pairs in counts_of_pairs(plans).items():
            if _uneven(pairs.values()):
                rare, often = (pick(pairs, key=pairs.__getitem__) for pick in (min, max))
                yield finding(
                    "conditions-uneven",
                    f"{listed(often)} are shown {pairs[often]} times, {listed(rare)} "
                    f"{pairs[rare]} times",
                    where=part or arm.name,
                )


def _uneven(times: Iterable[int]) -> bool:
    """Tell whether the most frequent is more than `TIMES` as frequent, and not by one or two."""
    counts = list(times)
    return bool(counts) and max(counts) > TIMES * min(counts) and max(counts) - min(counts) > 2


def _between(counts: list[int]) -> str:
    low, high = min(counts, default=0), max(counts, default=0)
    return f"{low}" if low == high else f"{low} to {high}"


def _some(names: list[str]) -> str:
    """Return some of many names."""
    if len(names) <= 5:
        return listed(names)
    return f"{', '.join(names[:4])} and {len(names) - 4} more"
