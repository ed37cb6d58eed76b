"""The report's first words, its methods and its limits: what every test decides, in sentences."""

from __future__ import annotations

import math
import platform
from collections import Counter
from dataclasses import dataclass
from importlib import metadata
from typing import Any, Final, Literal

from analysis.report import wording
from analysis.report.content import Section
from analysis.report.sections.heterogeneity import whole_effects
from analysis.report.sections.participants import looks_sentence, places_words
from analysis.report.subject import Subject
from analysis.report.texts import paragraphs
from analysis.report.wording import SIGNIFICANCE, between, number
from analysis.results.grouping import ResultKey, Row
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import FEWEST, Comparison, Decision, MatchedCondition
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatedDifference, RatingResults
from analysis.results.report import TableReport
from analysis.results.strengths import StrengthDifference
from analysis.stats.clustered_mean import LEVEL

MOST: Final = 4
"""How many of a kind a sentence names; the tables hold all of them."""

FEW_SEGMENTS: Final = 6
"""Segments below which the text says what few of them mean."""

ANCHOR: Final = "methods"
"""Of the section of methods, by which other parts find it."""

_LIBRARIES: Final = ("numpy", "scipy", "pandas", "matplotlib")

_MEASURES: Final = {"clmm": "log-odds", "win_share": "win share", "sign": "share of participants"}

Outcome = Literal["decided", "undecided", "untested", "outside"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """What one test of the report decides.

    Attributes
    ----------
    place : int
        Among all of them.
    outcome : {'decided', 'undecided', 'untested', 'outside'}
        Whether the corrected test decides, or there is none, or it is not of the report's family.
    better, worse : str
        What is ahead in the answers, and of what, as readers know them.
    question, set : str
        What was asked; empty where there are no sets.
    numbers, measure : str
        The estimate that the test is about, with its interval; and what that is.
    apart : bool
        Whether the interval leaves out no difference.
    size : float
        How far from no difference, to list the largest first; NaN for none.
    why, reason : str
        Why this test stands in for the usual one; why there is no test.
    """

    place: int
    outcome: Outcome
    better: str
    worse: str
    question: str
    set: str
    numbers: str
    measure: str
    apart: bool
    size: float
    why: str
    reason: str

    @property
    def pair(self) -> tuple[str, str]:
        """Both names, in an order that does not depend on the answers."""
        return (self.better, self.worse) if self.better < self.worse else (self.worse, self.better)


def verdicts(report: TableReport) -> tuple[Verdict, ...]:
    """Return what every test of the report decides, in the report's order."""
    results = report.results
    match results:
        case PairwiseResults(decided_by="comparisons"):
            return tuple(_preferred(*one) for one in enumerate(results.comparisons))
        case MismatchResults():
            return tuple(_preferred(*one) for one in enumerate(results.conditions))
        case RatingResults():
            return tuple(
                _verdict(place, one, one.difference, "mean difference")
                for place, one in enumerate(results.contrasts)
            )
        case _:
            what = "worths" if isinstance(results, RankingResults) else "strengths"
            return tuple(
                _verdict(place, one, one, f"difference of {what} in logits", why=one.remark)
                for place, one in enumerate(results.contrasts)
            )


def _preferred(place: int, one: Comparison | MatchedCondition) -> Verdict:
    found = one.decision
    return _verdict(
        place,
        one,
        found,
        _MEASURES[found.by],
        null=found.null,
        size=abs(one.win_share.estimate - 0.5),
        why=found.why,
        unknown=one.win_share.reason,
    )


def _verdict(
    place: int,
    of: ResultKey,
    found: Decision | RatedDifference | StrengthDifference,
    measure: str,
    *,
    null: float = 0.0,
    size: float | None = None,
    why: str = "",
    unknown: str | None = None,
) -> Verdict:
    """Return what a test of `found`, which is `null` without any difference, decides."""
    names = tuple(map(wording.condition, of.names))
    if len(names) == 1:
        names = (f"{names[0]} with its own speech", f"{names[0]} with another's speech")
    turned = found.estimate < null
    ends = found.low, found.high
    estimate, low, high = found.estimate, *ends
    if turned:
        estimate, low, high = 2 * null - estimate, 2 * null - high, 2 * null - low
    written = wording.share if null else number
    reason = found.reason or (NO_END if getattr(found, "by", "") == "sign" and not null else "")
    why_none = reason if unknown is None else unknown
    if math.isnan(estimate):
        numbers = f"– ({why_none or 'no answers'})"
    elif math.isnan(low):
        numbers = f"{written(estimate)}, no interval: {why_none}"
    else:
        numbers = (
            f"{written(estimate)}, {LEVEL:.0%} interval {between(written(low), written(high))}"
        )
    return Verdict(
        place=place,
        outcome=_outcome(found.p_value, found.p_holm),
        better=names[turned],
        worse=names[not turned],
        question=of.question,
        set=of.set or "",
        numbers=numbers,
        measure=measure,
        apart=ends[0] > null or ends[1] < null,
        size=abs(found.estimate) if size is None else size,
        why=why,
        reason=reason,
    )


NO_END: Final = "one of the two never lost to the other"


def _outcome(p: float, p_holm: float) -> Outcome:
    if math.isnan(p):
        return "untested"
    if math.isnan(p_holm):
        return "outside"
    return "decided" if p_holm < SIGNIFICANCE else "undecided"


def answer(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what was found in one sentence, what it rests on, and what it does not show."""
    if subject.origin == "none":
        scores = subject.metrics.conditions if subject.metrics else ()
        return paragraphs("answer.nobody", measured=len({one.condition for one in scores}))
    return paragraphs(
        "answer.nothing" if report.remark else "answer.answer", **_facts(report, subject)
    )


def certainty(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what a careful reader of the answer wants to know besides; () without one."""
    if subject.origin == "none" or report.remark:
        return ()
    return paragraphs("answer.certainty", **_facts(report, subject))


def _facts(report: TableReport, subject: Subject) -> dict[str, object]:
    """Return what the sentences of the answer rest on; of verdicts, the largest first."""
    results = report.results
    found = sorted(
        verdicts(report), key=lambda one: math.inf if math.isnan(one.size) else -one.size
    )
    people = report.participants
    tested = [one for one in found if one.outcome in ("decided", "undecided") and one.why]
    tested.sort(key=lambda one: one.place)
    equivalent = results.equivalence if isinstance(results, PairwiseResults | RatingResults) else ()
    return {
        "report": report,
        "people": subject.people,
        "rehearsal": subject.origin == "rehearsal",
        "found": found,
        "decided": [one for one in found if one.outcome == "decided"],
        "most": MOST,
        "equivalent": [one for one in equivalent if one.verdict.startswith("equivalent")],
        "excluded": people.recruited - people.attentive,
        "exploratory": sum(rule.removed for rule in report.rules if rule.exploratory),
        "segments": len(subject.excerpts),
        "speakers": len(subject.speakers),
        "places": places_words(report, subject),
        "looks": looks_sentence(report),
        "together": _together(report),
        "stand_ins": [*Counter((one.measure, one.why.rstrip(".")) for one in tested).items()],
        "unequal": [
            f"{wording.against(*names)}: {one.remark}"
            for (_, _, names), one in whole_effects(results).items()
            if one.remark
        ],
    }


def _together(report: TableReport) -> list[str]:
    """Return whether conditions differ at all, where strengths or worths decide."""
    match report.results:
        case PairwiseResults(decided_by="strengths", bradley_terry=strengths):
            models: list[Row[Any]] = [*strengths.rows()]
        case RankingResults(plackett_luce=worths):
            models = [*worths.rows()]
        case _:
            return []
    return [
        f"on {wording.name(row.question)}"
        + (f" in set “{wording.name(row.set)}”" if row.set else "")
        + f" ({wording.f_test(row.found.omnibus)})"
        for row in models
        if not math.isnan(row.found.omnibus.p_value)
    ]


def methods_section(report: TableReport, subject: Subject) -> Section:
    """Return the methods text, and what else a reader must know of settings."""
    facts = _study_facts(report, subject)
    return Section(
        anchor=ANCHOR,
        heading="Methods, ready to paste",
        paragraphs=paragraphs("methods.paragraphs", **facts),
        bullets=paragraphs("methods.bullets", **facts),
    )


def limits_section(report: TableReport, subject: Subject) -> Section:
    """Return what a reader may not take from the report."""
    return Section(
        anchor="limits",
        heading="What may not be concluded",
        bullets=paragraphs("methods.limits", **_study_facts(report, subject)),
    )


def _study_facts(report: TableReport, subject: Subject) -> dict[str, object]:
    results, excerpts = report.results, subject.excerpts.values()
    emotions = Counter(one.emotion for one in excerpts if one.emotion)
    seconds = [one.seconds for one in excerpts if one.seconds is not None]
    heard = [
        wording.count(count, noun)
        for count, noun in ((len(subject.speakers), "speaker"), (len(emotions), "emotion"))
        if count
    ]
    found = verdicts(report)
    fewest = min(emotions.values()) if len(emotions) > 1 else 0
    return {
        "report": report,
        "protocol": report.protocol,
        "subject": subject,
        "answered": subject.origin != "none",
        "excerpts": excerpts,
        "speakers": subject.speakers,
        "heard": [*heard, *([f"{wording.quantity(sum(seconds))} s in all"] if seconds else [])],
        "fewest": FEWEST,
        "few_segments": FEW_SEGMENTS,
        "fewest_of_emotion": fewest if fewest < FEW_SEGMENTS else 0,
        "tests": sum(one.outcome != "outside" for one in found),
        "undecided": any(one.outcome == "undecided" for one in found),
        "family": report.settings.family,
        "by_strengths": isinstance(results, PairwiseResults) and results.decided_by == "strengths",
        "measured": bool(subject.metrics and subject.metrics.conditions),
        "places": places_words(report, subject),
        "looks": looks_sentence(report),
        "python": platform.python_version(),
        "versions": ", ".join(f"{name} {metadata.version(name)}" for name in _LIBRARIES),
    }
