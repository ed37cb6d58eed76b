"""The report's first words: the study's question, answered in three sentences."""

from __future__ import annotations

from typing import Final

from analysis.report import wording
from analysis.report.flow_words import is_half_finished, places_words
from analysis.report.subject import Subject
from analysis.report.verdicts import (
    SIGNIFICANCE,
    Verdict,
    about,
    largest_first,
    leaders,
    share_with_interval,
    verdicts,
)
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.results.report import TableReport
from motion.listing import listed

MOST: Final = 4
"""How many results the first sentences name; the tables hold all of them."""


def answer(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return the answer: what was found, how sure it is, and what it does not show."""
    if subject.origin == "none":
        return (
            "No participant has answered yet, so this report says nothing about preference.",
            *_metrics_only(subject),
        )
    if report.remark:
        return (report.remark, *_unfinished(report, subject))
    if isinstance(report.results, RankingResults):
        effect, certainty = _ranked(report.results, subject), ""
    else:
        found = verdicts(report)
        effect, certainty = _effect(found, subject), _certainty(found)
    return (
        effect,
        " ".join(part for part in (certainty, _basis(report, subject)) if part),
        " ".join([_not_shown(report, subject), *_unfinished(report, subject)]),
    )


def _effect(found: tuple[Verdict, ...], subject: Subject) -> str:
    """Name what is decided, the largest first, or say that nothing is."""
    decided = largest_first([one for one in found if one.outcome == "decided"])
    tested = [one for one in found if one.outcome != "untested"]
    people = subject.people.capitalize()
    if not tested:
        reasons = list(dict.fromkeys(one.reason for one in found if one.reason))
        why = f": {reasons[0]}" if len(reasons) == 1 else "; the tables say why"
        return f"No test could be made{why}."
    family = wording.count(len(found), "test")
    if not decided:
        first = largest_first(tested)[0]
        return (
            f"None of {family} decides between what was compared (p at least "
            f"{SIGNIFICANCE:g} after Holm's correction); the largest difference is that of "
            f"{_named(first, measured=True)}."
        )
    named = [_named(one, measured=place == 0) for place, one in enumerate(decided[:MOST])]
    more = len(decided) - len(named)
    further = f", and {more} more of {family}" if more else ""
    return f"{people} preferred {listed(named)}{further}."


def _named(one: Verdict, *, measured: bool) -> str:
    measure = f"{one.measure} " if measured else ""
    return (
        f"{wording.name(one.better)} to {wording.name(one.worse)} "
        f"{about(one.question, one.set)} ({measure}{one.numbers})"
    )


def _certainty(found: tuple[Verdict, ...]) -> str:
    """Name what stays open."""
    undecided = [one for one in found if one.outcome == "undecided"]
    untested = [one for one in found if one.outcome == "untested"]
    words = []
    if undecided and len(undecided) < len(found):
        words.append(_open(undecided, len(found)))
    if untested:
        words.append(f"{wording.count(len(untested), 'test')} could not be made")
    text = "; ".join(words)
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _open(undecided: list[Verdict], tests: int) -> str:
    """Name a few undecided tests, or count many."""
    if len(undecided) >= MOST:
        return f"{len(undecided)} of {tests} tests do not decide"
    pairs = [
        f"{wording.name(a)} and {wording.name(b)} {about(one.question, one.set)}"
        for one in undecided
        for a, b in (one.pair,)
    ]
    return f"the answers do not decide between {'; '.join(pairs)}"


def _ranked(results: RankingResults, subject: Subject) -> str:
    """Name the best mean rank of each question."""
    firsts = []
    for place, ordered in enumerate(leaders(results)):
        best = ordered[0]
        firsts.append(
            f"{wording.name(best.condition)} {about(best.question, best.set or '')} "
            f"({_rank_numbers(best, first=place == 0)})"
        )
    rest = f", and so on for {len(firsts) - MOST} more" if len(firsts) > MOST else ""
    return (
        f"{subject.people.capitalize()} placed best, by mean rank, {listed(firsts[:MOST])}{rest}; "
        "which ranks the others may have is in the tables."
    )


def _rank_numbers(best: RankedCondition, *, first: bool) -> str:
    share = share_with_interval(best.first_share_interval, turned=False)
    of = "first places " if first else ""
    return f"mean rank {wording.fixed(best.mean_rank, 2)}; {of}{share}"


def _basis(report: TableReport, subject: Subject) -> str:
    participants = report.participants
    excluded = participants.recruited - participants.attentive
    exploratory = sum(rule.removed for rule in report.rules if rule.exploratory)
    words = (
        f"This rests on {participants.attentive} of "
        f"{wording.count(participants.recruited, subject.people[:-1])}"
    )
    if subject.excerpts:
        speakers = {one.speaker for one in subject.excerpts.values() if one.speaker}
        words += f" and {wording.count(len(subject.excerpts), 'segment')}"
        words += f" of {wording.count(len(speakers), 'speaker')}" if speakers else ""
    words += "; nobody was excluded" if not excluded else f"; {excluded} were excluded by rules"
    if excluded == 1:
        words = words.replace("1 were excluded", "1 was excluded")
    if exploratory:
        words += f", {exploratory} of them by rules added after the answers, which is exploratory"
    return f"{words}."


def _not_shown(report: TableReport, subject: Subject) -> str:
    if subject.origin == "rehearsal":
        return (
            "It does not show what any person prefers: simulated raters answered by rules they "
            "were given."
        )
    undecided = any(one.outcome == "undecided" for one in verdicts(report))
    equal = (
        " That a test does not decide is no evidence that two conditions are equally good."
        if undecided and report.settings.margin is None
        else ""
    )
    return (
        "It does not show how other systems, other speech, other speakers or differently worded "
        f"questions would do.{equal}"
    )


def _unfinished(report: TableReport, subject: Subject) -> tuple[str, ...]:
    if not is_half_finished(report, subject):
        return ()
    return (
        f"The study is not finished: {places_words(report)}. Numbers will change, and to stop "
        "because of what they show now would make false findings likelier.",
    )


def _metrics_only(subject: Subject) -> tuple[str, ...]:
    if subject.metrics is None or not subject.metrics.conditions:
        return ()
    conditions = {score.condition for score in subject.metrics.conditions}
    return (
        f"It shows the automatic metrics of {wording.count(len(conditions), 'condition')}; "
        "they do not tell what people prefer.",
    )
