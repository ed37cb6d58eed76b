"""The report's first words: the study's question, answered in three sentences."""

from __future__ import annotations

from typing import Final

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.by_question import each_question
from analysis.report.flow_words import is_half_finished, places_words
from analysis.report.looks_section import looks_sentence
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
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankedCondition, RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import Results, TableReport
from analysis.results.strength_errors import RankInterval
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
        effect, certainty = _ranked(report, report.results, subject), ""
    else:
        found = verdicts(report)
        effect, certainty = _effect(found, subject), _certainty(found)
    return (
        effect,
        " ".join(
            part
            for part in (certainty, _equivalent(report.results), _basis(report, subject))
            if part
        ),
        " ".join(
            part
            for part in (
                _not_shown(report, subject),
                *_unfinished(report, subject),
                looks_sentence(report),
            )
            if part
        ),
    )


def _effect(found: tuple[Verdict, ...], subject: Subject) -> str:
    """Name what is decided, the largest first, or say that nothing is."""
    decided = largest_first([one for one in found if one.outcome == "decided"])
    tested = [one for one in found if one.outcome != "untested"]
    people = subject.people.capitalize()
    if not tested:
        reasons = list(dict.fromkeys(one.reason for one in found if one.reason))
        why = f": {reasons[0]}" if len(reasons) == 1 else "; the tables say why"
        seen = [one for one in largest_first(found) if one.size > 0]
        widest = (
            f"; the largest difference is that of {_named(seen[0], measured=True)}" if seen else ""
        )
        return f"No test could be made{why}{widest}."
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


def _ranked(report: TableReport, results: RankingResults, subject: Subject) -> str:
    """Name the best mean rank of each question."""
    ranks = {
        (of, question, name): found
        for of, question, worths in each_question(results.plackett_luce, report.sets)
        for name, found in worths.ranks.items()
    }
    firsts = []
    for ordered in leaders(results):
        best, of = ordered[0], ordered[0].set or ""
        if best.mean_rank == ordered[-1].mean_rank:
            firsts.append(f"none before the others {about(best.question, of)}")
            continue
        numbers = _rank_numbers(best, ranks.get((of, best.question, best.condition)))
        firsts.append(f"{wording.name(best.condition)} {about(best.question, of)} ({numbers})")
    rest = f", and so on for {len(firsts) - MOST} more" if len(firsts) > MOST else ""
    return (
        f"{subject.people.capitalize()} placed best, by mean rank, {listed(firsts[:MOST])}{rest}; "
        "which ranks the others may have is in the tables."
    )


def _rank_numbers(best: RankedCondition, ranks: RankInterval | None) -> str:
    share = share_with_interval(best.first_share_interval)
    words = f"mean rank {wording.fixed(best.mean_rank, 2)}; first places {share}"
    if ranks is None:
        return words
    span = f"{ranks.best}" if ranks.best == ranks.worst else f"{ranks.best}–{ranks.worst}"
    return f"{words}; its rank may be {span} at {LEVEL:.0%}"


def _equivalent(results: Results) -> str:
    """Name what is equivalent within the margin that was stated."""
    if not isinstance(results, PairwiseResults | RatingResults):
        return ""
    alike = [one for one in results.equivalence if one.verdict.startswith("equivalent")]
    if not alike:
        return ""
    pairs = [
        f"{wording.name(one.a)} and {wording.name(one.b)} {about(one.question, one.set or '')}"
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
        speakers = {one.speaker for one in subject.excerpts.values() if one.speaker}
        words += f" and {wording.count(len(subject.excerpts), 'segment')}"
        words += f" of {wording.count(len(speakers), 'speaker')}" if speakers else ""
    words += "; nobody was excluded" if not excluded else f"; {excluded} were excluded"
    if excluded == 1:
        words = words.replace("1 were excluded", "1 was excluded")
    if exploratory:
        words += f", {exploratory} of them afterwards, which is exploratory"
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
