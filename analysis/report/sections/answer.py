"""The report's first words: the study's question answered, and how sure that is."""

from __future__ import annotations

import math
from typing import Final

from analysis.report import wording
from analysis.report.sections.flow import is_half_finished, looks_sentence, places_words
from analysis.report.sections.heterogeneity import whole_effects
from analysis.report.sections.verdicts import SIGNIFICANCE, Verdict, about, largest_first, verdicts
from analysis.report.subject import Subject
from analysis.results.grouping import ByQuestion
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import Results, TableReport
from analysis.results.strengths import Standings
from motion.errors import listed

MOST: Final = 4
"""How many of a kind a sentence names; the tables hold all of them."""


def answer(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what was found in one sentence, what it rests on, and what it does not show."""
    if subject.origin == "none":
        return (
            "No participant has answered yet, so this report says nothing about preference.",
            *_metrics_only(subject),
        )
    warning = _unfinished(report, subject)
    if report.remark:
        return tuple(filter(None, (report.remark, warning)))
    effect = _effect(verdicts(report), report, subject)
    return (
        effect,
        _basis(report, subject),
        warning or looks_sentence(report) or _not_shown(subject),
    )


def certainty(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what a careful reader of the answer wants to know besides; () without one."""
    if subject.origin == "none" or report.remark:
        return ()
    found = verdicts(report)
    return tuple(
        part
        for part in (
            _further(found),
            _together(report),
            _undecided(found),
            _stand_ins(found),
            _seeming(found),
            _equivalent(report.results),
            _unequal(report.results),
            _equality(report, subject, found),
            *_after_the_warning(report, subject),
        )
        if part
    )


def _effect(found: tuple[Verdict, ...], report: TableReport, subject: Subject) -> str:
    """Name the largest of what is decided, or say that nothing is."""
    decided = largest_first([one for one in found if one.outcome == "decided"])
    found = tuple(one for one in found if one.outcome != "outside")
    tested = [one for one in found if one.outcome != "untested"]
    if not tested:
        reasons = list(dict.fromkeys(one.reason for one in found if one.reason))
        why = f": {reasons[0]}" if len(reasons) == 1 else "; the tables say why"
        seen = [one for one in largest_first(found) if one.size > 0]
        widest = f"; the largest difference is that of {_named(seen[0])}" if seen else ""
        return f"No test could be made{why}{widest}."
    if not decided:
        alike = _equivalent(report.results).rstrip(".")
        equivalent = f"; {alike[0].lower()}{alike[1:]}" if alike else ""
        return (
            f"None of {wording.count(len(found), 'test')} decides between what was compared (p at "
            f"least {SIGNIFICANCE:g} after Holm's correction); the largest difference is that of "
            f"{_named(largest_first(tested)[0])}{equivalent}."
        )
    others = _others(len(decided) - 1, len(found) - 1)
    return f"{subject.people.capitalize()} preferred {_named(decided[0])}{others}."


def _others(decided: int, others: int) -> str:
    """Say how many of the other tests decide too, as the end of a sentence."""
    if not others:
        return ""
    if others == 1:
        return f"; the other test {'decides too' if decided else 'does not decide'}"
    of = f"of the other {others} tests"
    if not decided:
        return f"; none {of} decides"
    return f"; {decided} {of} {'decides' if decided == 1 else 'decide'} too"


def _further(found: tuple[Verdict, ...]) -> str:
    """Name what else is decided, the largest first."""
    decided = largest_first([one for one in found if one.outcome == "decided"])[1:]
    named = [_named(one) for one in decided[:MOST]]
    more = f", and {len(decided) - len(named)} more" if len(decided) > len(named) else ""
    return f"Also preferred: {'; '.join(named)}{more}." if named else ""


def _named(one: Verdict) -> str:
    return (
        f"{one.better} to {one.worse} {about(one.question, one.set)} ({one.measure} {one.numbers})"
    )


def _undecided(found: tuple[Verdict, ...]) -> str:
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
        f"{a} and {b} {about(one.question, one.set)}" for one in undecided for a, b in (one.pair,)
    ]
    return f"the answers do not decide between {'; '.join(pairs)}"


def _together(report: TableReport) -> str:
    """Say whether conditions differ at all, where strengths or worths decide."""
    match report.results:
        case PairwiseResults(decided_by="strengths", bradley_terry=fitted):
            models: ByQuestion[Standings] = fitted
        case RankingResults(plackett_luce=fitted_worths):
            models = fitted_worths
        case _:
            return ""
    parts = [
        f"{about(question, of)} (F({test.df:.0f}, {wording.quantity(test.df_rest)}) = "
        f"{wording.fixed(test.statistic, 2)}, {wording.p_is(test.p_value)})"
        for of, question, model in models.rows()
        for test in (model.omnibus,)
        if not math.isnan(test.p_value)
    ]
    more = f", and {len(parts) - MOST} more" if len(parts) > MOST else ""
    return f"One test of all conditions together: {listed(parts[:MOST])}{more}." if parts else ""


def _stand_ins(found: tuple[Verdict, ...]) -> str:
    """Name tests that stand in for the usual one, and why."""
    by_reason: dict[tuple[str, str], int] = {}
    for one in found:
        if one.why and one.outcome in ("decided", "undecided"):
            key = one.measure, one.why.rstrip(".")
            by_reason[key] = by_reason.get(key, 0) + 1
    named = [
        f"{wording.count(count, 'test')} {'is' if count == 1 else 'are'} of the {measure}, because "
        f"the usual test cannot be used ({why})"
        for (measure, why), count in list(by_reason.items())[:2]
    ]
    more = "; the tables name others" if len(by_reason) > 2 else ""
    text = "; ".join(named)
    return f"{text[0].upper()}{text[1:]}{more}." if text else ""


def _seeming(found: tuple[Verdict, ...]) -> str:
    """Say why an interval may leave out no difference where the test does not decide."""
    seeming = sum(one.apart and one.outcome == "undecided" for one in found)
    if not seeming:
        return ""
    verb = "leaves" if seeming == 1 else "leave"
    return (
        f"Intervals stand for one test at a time: {seeming} of them {verb} out no difference, "
        f"although p, corrected over {wording.count(len(found), 'test')}, does not decide."
    )


def _unequal(results: Results) -> str:
    """Warn where one participant weighs much more than the others."""
    said = [
        f"{wording.against(*names)}: {found.remark}"
        for (_, _, names), found in whole_effects(results).items()
        if found.remark
    ]
    more = f" (and {len(said) - 1} more)" if len(said) > 1 else ""
    return f"Participants answered very unequally often. {said[0]}{more}." if said else ""


def _equivalent(results: Results) -> str:
    """Name what is equivalent within the margin that was stated."""
    if not isinstance(results, PairwiseResults | RatingResults):
        return ""
    alike = [one for one in results.equivalence if one.verdict.startswith("equivalent")]
    if not alike:
        return ""
    pairs = [
        f"{wording.condition(one.a)} and {wording.condition(one.b)} "
        f"{about(one.question, one.set or '')}"
        for one in alike[:MOST]
    ]
    more = f", and {len(alike) - MOST} more" if len(alike) > MOST else ""
    return f"Equivalent within {alike[0].margin:g} are {'; '.join(pairs)}{more}."


def _basis(report: TableReport, subject: Subject) -> str:
    participants = report.participants
    excluded = participants.recruited - participants.attentive
    exploratory = sum(rule.removed for rule in report.rules if rule.exploratory)
    words = (
        f"This rests on {participants.attentive} of "
        f"{wording.count(participants.recruited, subject.people[:-1])}"
    )
    if subject.excerpts:
        words += f" and {wording.count(len(subject.excerpts), 'segment')}"
        words += (
            f" of {wording.count(len(subject.speakers), 'speaker')}" if subject.speakers else ""
        )
    words += "; nobody was excluded" if not excluded else f"; {excluded} were excluded"
    if excluded == 1:
        words = words.replace("1 were excluded", "1 was excluded")
    if exploratory:
        words += f", {exploratory} of them afterwards, which is exploratory"
    return f"{words}."


def _not_shown(subject: Subject) -> str:
    if subject.origin == "rehearsal":
        return (
            "It does not show what any person prefers: simulated raters answered by rules they "
            "were given."
        )
    return (
        "It does not show how other systems, other speech, other speakers or differently worded "
        "questions would do."
    )


def _equality(report: TableReport, subject: Subject, found: tuple[Verdict, ...]) -> str:
    if subject.origin == "rehearsal" or report.settings.margin is not None:
        return ""
    if not any(one.outcome == "undecided" for one in found):
        return ""
    return "That a test does not decide is no evidence that two conditions are equally good."


def _unfinished(report: TableReport, subject: Subject) -> str:
    if not is_half_finished(report, subject):
        return ""
    return f"The study is not finished, and numbers will change: {places_words(report)}."


def _after_the_warning(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what a warning has taken the place of in the answer."""
    looks, unfinished = looks_sentence(report), _unfinished(report, subject)
    if not (looks or unfinished):
        return ()
    stopping = (
        "To stop because of what the numbers of an unfinished study show would make false "
        "findings likelier."
    )
    return (*((stopping, looks) if unfinished else ()), _not_shown(subject))


def _metrics_only(subject: Subject) -> tuple[str, ...]:
    if subject.metrics is None or not subject.metrics.conditions:
        return ()
    conditions = {score.condition for score in subject.metrics.conditions}
    return (
        f"It shows the automatic metrics of {wording.count(len(conditions), 'condition')}; "
        "they do not tell what people prefer.",
    )
