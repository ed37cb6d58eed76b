"""What the design shows participants, whom it leaves out, and whether it is balanced."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
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
        f"{place}. who {rule.to_rule().description} ({rule.shorthand()})"
        for place, rule in enumerate(rules, start=1)
    )
    yield finding("exclusions", rules=said or "nobody")
    for rule in rules:
        if isinstance(rule, Coverage) and rule.below <= study.watching.coverage:
            yield finding(
                "exclusion-without-effect",
                rule=rule.shorthand(),
                coverage=study.watching.coverage,
            )


def _extra_findings(plan: Sequence[PlannedTrial]) -> Iterator[Finding]:
    """Say how many extra trials have speech that comes in another trial as well."""
    extra = [trial.segment for trial in plan if trial.kind in ("catch", "attention")]
    times = Counter(trial.segment for trial in plan)
    again = sum(times[segment] > 1 for segment in extra)
    if again:
        yield finding("speech-repeated", again=again, extra=len(extra))


def balance_findings(material: Material) -> Iterator[Finding]:
    """Count how often the planned participants will judge each segment, and say which never."""
    planned = list(material.plans)
    if not any(planned):
        return
    if material.study.follows_votes:
        yield finding(
            "balance",
            "pairs are chosen as answers come, so that what participants will see cannot be "
            "counted beforehand",
        )
        return
    judged = Counter(
        trial.segment.name for plan in planned for trial in plan if trial.kind in ("main", "repeat")
    )
    most = max(arm.places for arm in material.study.arms)
    of = f" (the first {MOST_PLACES} of each arm)" if most > MOST_PLACES else ""
    low, high = min(judged.values(), default=0), max(judged.values(), default=0)
    times = f"{low}" if low == high else f"{low} to {high}"
    yield finding(
        "balance", f"{len(planned)} planned participants{of} judge each segment {times} times"
    )
    if unused := [name for name in material.by_name if not judged[name]]:
        yield finding("segments-unused", segments=_some(unused))


def _some(names: list[str]) -> str:
    """Return some of many names."""
    if len(names) <= 5:
        return listed(names)
    return f"{', '.join(names[:4])} and {len(names) - 4} more"
