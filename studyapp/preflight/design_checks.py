"""What the design shows participants, whom it leaves out, and whether it is balanced."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
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


def analysed(plans: Plans) -> list[PlannedTrial]:
    """Return the trials whose answers are analysed."""
    return [trial for plan in plans for trial in plan if trial.kind in ANALYSED]


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
    together = [plan for _, plans in planned for plan in plans]
    segments = counts_of_segments(together, list(material.by_name))
    yield finding("balance", _balance(material, segments))
    yield from _count_findings(material, segments)


def _balance(material: Material, segments: dict[str, int]) -> str:
    participants = sum(len(plans) for _, plans in material.planned)
    most = max(arm.places for arm in material.study.arms)
    of = f" (the first {MOST_PLACES} of each arm)" if most > MOST_PLACES else ""
    used = [times for times in segments.values() if times]
    return f"{participants} planned participants{of} judge each segment {_between(used)} times"


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
