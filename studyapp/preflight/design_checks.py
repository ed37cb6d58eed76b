"""What participants will see, who is excluded, and whether the design is balanced."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Final

from motion.errors import listed
from motion.segment import EMOTIONS
from studyapp.preflight.finding import Finding, make_finding
from studyapp.preflight.material import MOST_PLACES, Material
from studyapp.study.design.trial import Kind
from studyapp.study.settings.conditions import study_notes
from studyapp.study.settings.exclusions import FailedAttention, FailedCatch
from studyapp.study.settings.study import Study

KIND_WORDS: Final[Mapping[Kind, str]] = {
    "practice": "practice (discarded)",
    "main": "main",
    "repeat": "practice repeated (analysed)",
    "catch": "catch",
    "attention": "attention",
}


def design_findings(material: Material) -> Iterator[Finding]:
    """Yield the trials of a participant, and what the design cannot show."""
    study, segments = material.study, material.segments
    if not study.open:
        yield make_finding("closed")
    plan = next(material.plans, ())
    counts = Counter(trial.kind for trial in plan)
    kinds = ", ".join(
        f"{counts[kind]} {words}" for kind, words in KIND_WORDS.items() if counts[kind]
    )
    if not (counts["main"] or counts["practice"]):
        yield make_finding("no-trials", segments=len(segments))
        return
    yield make_finding("trials", count=len(plan), kinds=kinds)
    for sentence in (*study.notes(segments), *study_notes(study)):
        yield make_finding("design", sentence.rstrip("."))
    if any("{emotion}" in question.text for question in study.questions):
        emotions = {segment.emotion for segment in segments}
        missing = [emotion for emotion in EMOTIONS if emotion not in emotions]
        if not any(segment.wav for segment in segments):
            yield make_finding("emotions-unknown", emotions=listed(sorted(emotions)))
        elif missing:
            yield make_finding("emotions-missing", emotions=listed(missing))
    yield from _check_findings(study)
    yield from _exclusion_findings(study)


def _check_findings(study: Study) -> Iterator[Finding]:
    """Yield whether inattentive participants cannot be identified."""
    if not study.catch.trials and not study.attention.trials:
        yield make_finding("no-checks")
    elif not study.catch.trials:
        yield make_finding("no-catch-trials")
    for rule in study.settled_exclusions:
        if isinstance(rule, FailedCatch):
            trials, words = study.catch.trials, "catch trials"
        elif isinstance(rule, FailedAttention):
            trials, words = study.attention.trials, "attention checks"
        else:
            continue
        if trials <= rule.more_than:
            yield make_finding(
                "checks-few",
                where=f"{rule.rule}.max_failed",
                allowed=rule.more_than,
                trials=trials,
                words=words,
            )


def _exclusion_findings(study: Study) -> Iterator[Finding]:
    """Yield who will be excluded."""
    rules = study.settled_exclusions
    numbered = "; ".join(
        f"{number}. who {rule.to_rule().description} ({rule.shorthand()})"
        for number, rule in enumerate(rules, start=1)
    )
    yield make_finding("exclusions", rules=numbered or "nobody")


def balance_findings(material: Material) -> Iterator[Finding]:
    """Yield how often the planned participants will judge each segment."""
    planned = list(material.plans)
    used = {trial.part for plan in planned for trial in plan}
    if empty := [part for part in material.study.parts if part not in used]:
        yield make_finding("parts-unused", parts=listed(empty))
    if not any(planned):
        return
    if material.study.follows_votes:
        yield make_finding(
            "balance",
            "pairs are chosen as answers arrive, so what participants will see cannot be counted "
            "in advance",
        )
        return
    judged = Counter(
        trial.segment.name for plan in planned for trial in plan if trial.kind in ("main", "repeat")
    )
    most = max(arm.places for arm in material.study.arms)
    limit = f" (the first {MOST_PLACES} of each arm)" if most > MOST_PLACES else ""
    low, high = min(judged.values(), default=0), max(judged.values(), default=0)
    times = f"{low}" if low == high else f"{low} to {high}"
    yield make_finding(
        "balance", f"{len(planned)} planned participants{limit} judge each segment {times} times"
    )
    unused = [name for name in material.segments_by_name if not judged[name]]
    if unused:
        many = len(unused) > 5
        names = [*unused[:4], f"{len(unused) - 4} more"] if many else unused
        yield make_finding("segments-unused", segments=listed(names))
