"""The report's first sentences, its methods and its limits: the outcome of every test in words."""

import math
import platform
from collections import Counter
from dataclasses import dataclass
from importlib import metadata
from typing import Any, Final, Literal

from analysis.report import wording
from analysis.report.content import Section, Subject
from analysis.report.sections.heterogeneity import overall_effects
from analysis.report.sections.participants import looks_sentence, places_words
from analysis.report.texts import paragraphs
from analysis.report.wording import INTERVAL, SIGNIFICANCE, between, number
from analysis.results.conditions import RankingResults, RatedDifference, RatingResults
from analysis.results.grouping import ResultKey, Row
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import FEWEST, Comparison, Decision, MatchedCondition
from analysis.results.report import TableReport
from analysis.results.strengths import StrengthDifference

MOST: Final = 4
"""Most items of a kind that a sentence names; the tables hold all of them."""

FEW_SEGMENTS: Final = 6
"""Segments below which the text warns of wide intervals."""

METHODS_ANCHOR: Final = "methods"

_LIBRARIES: Final = ("numpy", "scipy", "pandas", "matplotlib")

_MEASURES: Final = {"clmm": "log-odds", "win_share": "win share", "sign": "share of participants"}

_ALL_WON: Final = "one of the two never lost to the other"

Outcome = Literal["significant", "not significant", "untested", "outside the family"]


@dataclass(frozen=True, kw_only=True)
class Verdict:
    """The outcome of one test.

    Attributes
    ----------
    outcome : {'significant', 'not significant', 'untested', 'outside the family'}
        Outcome of the corrected test.
    better, worse : str
        The two sides, as the answers order them.
    question, set : str
        The question, and its set; '' without sets.
    measure, numbers : str
        The name of the measure; the estimate with its interval.
    excludes_null : bool
        Whether the interval excludes no difference.
    size : float
        Distance from no difference; NaN if unknown.
    why : str
        Why this test replaces the usual one.
    reason : str
        Why there is no test.
    """

    outcome: Outcome
    better: str
    worse: str
    question: str
    set: str
    measure: str
    numbers: str
    excludes_null: bool
    size: float
    why: str
    reason: str

    @property
    def pair(self) -> tuple[str, str]:
        """Both names, in an order that does not depend on the answers."""
        return (self.better, self.worse) if self.better < self.worse else (self.worse, self.better)


def verdicts(report: TableReport) -> tuple[Verdict, ...]:
    """Return the outcome of every test, in the report's order."""
    results = report.results
    match results:
        case PairwiseResults(decided_by="comparisons"):
            return tuple(map(_preference_verdict, results.comparisons))
        case MismatchResults():
            return tuple(map(_preference_verdict, results.conditions))
        case RatingResults():
            return tuple(
                _verdict(contrast, contrast.difference, "mean difference")
                for contrast in results.contrasts
            )
        case _:
            kind = "worths" if isinstance(results, RankingResults) else "strengths"
            measure = f"difference of {kind} in logits"
            return tuple(
                _verdict(contrast, contrast, measure, why=contrast.remark)
                for contrast in results.contrasts
            )


def _preference_verdict(result: Comparison | MatchedCondition) -> Verdict:
    decision = result.decision
    return _verdict(
        result,
        decision,
        _MEASURES[decision.by],
        null=decision.null,
        size=abs(result.win_share.estimate - 0.5),
        why=decision.why,
    )


def _verdict(
    subject: ResultKey,
    test: Decision | RatedDifference | StrengthDifference,
    measure: str,
    *,
    null: float = 0.0,
    size: float | None = None,
    why: str = "",
) -> Verdict:
    """Return the outcome of a test; `null` is the estimate of no difference."""
    names = tuple(map(wording.condition, subject.names))
    if len(names) == 1:
        names = (f"{names[0]} with its own speech", f"{names[0]} with another's speech")
    estimate, low, high = test.estimate, test.low, test.high
    second_is_better = estimate < null
    if second_is_better:
        estimate, low, high = 2 * null - estimate, 2 * null - high, 2 * null - low
    reason = test.reason
    if isinstance(test, StrengthDifference) and test.by == "sign":
        reason = reason or _ALL_WON
    formatted = wording.share if null else number
    if math.isnan(estimate):
        numbers = f"– ({reason or 'no answers'})"
    elif math.isnan(low):
        numbers = f"{formatted(estimate)}, no interval: {reason}"
    else:
        numbers = f"{formatted(estimate)}, {INTERVAL} {between(formatted(low), formatted(high))}"
    return Verdict(
        outcome=_outcome(test.p_value, test.p_holm),
        better=names[second_is_better],
        worse=names[not second_is_better],
        question=subject.question,
        set=subject.set or "",
        measure=measure,
        numbers=numbers,
        excludes_null=test.low > null or test.high < null,
        size=abs(test.estimate) if size is None else size,
        why=why,
        reason=reason,
    )


def _outcome(p: float, p_holm: float) -> Outcome:
    if math.isnan(p):
        return "untested"
    if math.isnan(p_holm):
        return "outside the family"
    return "significant" if p_holm < SIGNIFICANCE else "not significant"


def answer(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return the result in one sentence, what it rests on, and what it does not show."""
    if subject.origin == "none":
        scores = subject.metrics.conditions if subject.metrics else ()
        return paragraphs("answer.nobody", measured=len({score.condition for score in scores}))
    macro = "answer.nothing" if report.remark else "answer.answer"
    return paragraphs(macro, **_answer_facts(report, subject))


def certainty(report: TableReport, subject: Subject) -> tuple[str, ...]:
    """Return what a careful reader of the answer also wants to know; () without an answer."""
    if subject.origin == "none" or report.remark:
        return ()
    return paragraphs("answer.certainty", **_answer_facts(report, subject))


def _answer_facts(report: TableReport, subject: Subject) -> dict[str, object]:
    """Return the facts behind the answer; the verdicts are ordered by size."""
    results = report.results
    in_order = verdicts(report)
    by_size = sorted(in_order, key=lambda v: math.inf if math.isnan(v.size) else -v.size)
    replaced = [v for v in in_order if v.outcome in ("significant", "not significant") and v.why]
    return {
        "report": report,
        "people": subject.people,
        "rehearsal": subject.origin == "rehearsal",
        "verdicts": by_size,
        "significant": [v for v in by_size if v.outcome == "significant"],
        "undecided": [v for v in in_order if v.outcome == "not significant"],
        "most": MOST,
        "equivalent": [
            pair
            for pair in getattr(results, "equivalence", ())
            if pair.verdict.startswith("equivalent")
        ],
        "excluded": report.participants.recruited - report.participants.attentive,
        "exploratory": sum(rule.removed for rule in report.rules if rule.exploratory),
        "segments": report.segments,
        "speakers": len(subject.speakers),
        "places": places_words(report, subject),
        "looks": looks_sentence(report),
        "omnibus": _omnibus_tests(report),
        "stand_ins": [
            *Counter(
                (
                    "win share" if v.measure == _MEASURES["win_share"] else "exact sign test",
                    v.why.rstrip("."),
                )
                for v in replaced
            ).items()
        ],
        "unequal": [
            f"{wording.against(*names)}: {effect.remark}"
            for (_, _, names), effect in overall_effects(results).items()
            if effect.remark
        ],
    }


def _omnibus_tests(report: TableReport) -> list[Row[Any]]:
    """Return the models with a test of all conditions, if strengths or worths are tested."""
    match report.results:
        case PairwiseResults(decided_by="strengths", bradley_terry=strengths):
            models: list[Row[Any]] = [*strengths.rows()]
        case RankingResults(plackett_luce=worths):
            models = [*worths.rows()]
        case _:
            return []
    return [row for row in models if not math.isnan(row.result.omnibus.p_value)]


def methods_section(report: TableReport, subject: Subject) -> Section:
    """Return the methods text for a paper, and further remarks."""
    facts = _study_facts(report, subject)
    return Section(
        anchor=METHODS_ANCHOR,
        heading="Methods, ready to paste",
        paragraphs=paragraphs("methods.paragraphs", **facts),
        bullets=paragraphs("methods.bullets", **facts),
    )


def limits_section(report: TableReport, subject: Subject) -> Section:
    """Return what a reader may not conclude from the report."""
    return Section(
        anchor="limits",
        heading="What may not be concluded",
        bullets=paragraphs("methods.limits", **_study_facts(report, subject)),
    )


def _study_facts(report: TableReport, subject: Subject) -> dict[str, object]:
    results, excerpts = report.results, subject.excerpts.values()
    emotions = Counter(excerpt.emotion for excerpt in excerpts if excerpt.emotion)
    seconds = sum(excerpt.duration for excerpt in excerpts)
    speech = [
        wording.count(count, noun)
        for count, noun in ((len(subject.speakers), "speaker"), (len(emotions), "emotion"))
        if count
    ]
    if seconds:
        speech.append(f"{wording.quantity(seconds)} s in all")
    outcomes = [verdict.outcome for verdict in verdicts(report)]
    fewest = min(emotions.values()) if len(emotions) > 1 else 0
    return {
        "report": report,
        "protocol": report.protocol,
        "subject": subject,
        "answered": subject.origin != "none",
        "excerpts": excerpts,
        "speakers": subject.speakers,
        "speech": speech,
        "fewest": FEWEST,
        "few_segments": FEW_SEGMENTS,
        "fewest_of_emotion": fewest if fewest < FEW_SEGMENTS else 0,
        "tests": sum(outcome != "outside the family" for outcome in outcomes),
        "undecided": "not significant" in outcomes,
        "family": report.settings.family,
        "by_strengths": isinstance(results, PairwiseResults) and results.decided_by == "strengths",
        "measured": bool(subject.metrics and subject.metrics.conditions),
        "places": places_words(report, subject),
        "looks": looks_sentence(report),
        "python": platform.python_version(),
        "versions": ", ".join(f"{name} {metadata.version(name)}" for name in _LIBRARIES),
    }
