"""The section in which a reader plays the pairs that were preferred most and least."""

from __future__ import annotations

import math

from analysis.measurement.scores import StudyMetrics
from analysis.metrics.result import MetricResult
from analysis.report import wording
from analysis.report.content import PlayablePair, Section, Table
from analysis.report.sections.metric import is_detail
from analysis.report.sections.metric_table import ARROWS
from analysis.report.subject import Subject
from analysis.report.texts import table
from analysis.results.preferred_pairs import PreferredPair

_EXPLANATION = (
    "For every two conditions, this shows the segment in which the first was preferred most and "
    "the one in which it was preferred least, sorted by win share. They are extremes, chosen after "
    "the answers were seen: they are examples, not evidence of how conditions differ. You can turn "
    "the bodies around. The body is the study's avatar, even where participants saw another body."
)


def played_pairs_section(subject: Subject) -> Section | None:
    """Return the pairs with their metrics; None where the page does not play any motion."""
    motion = subject.motion
    if motion is None:
        return None
    return Section(
        anchor="motion",
        heading="The most and least preferred pairs",
        paragraphs=(_EXPLANATION,) if motion.pairs else (),
        bullets=motion.left_out,
        playable=tuple(
            PlayablePair(
                element=element,
                caption=_caption(pair, subject),
                table=_metrics(pair, subject.metrics, subject.protocol),
            )
            for pair, element in motion.pairs
        ),
    )


def _caption(pair: PreferredPair, subject: Subject) -> str:
    shares = "; ".join(
        f"{wording.name(question)} {wording.share(share)} "
        f"({wording.count(pair.answers[question], 'answer')})"
        for question, share in pair.win_shares.items()
    )
    excerpt = subject.excerpts.get(pair.segment)
    said = f" It says: “{excerpt.transcript}”" if excerpt and excerpt.transcript else ""
    return (
        f"{wording.against(pair.first, pair.second)}, segment {wording.name(pair.segment)}. "
        f"Win share of {wording.condition(pair.first)}: {shares}.{said}"
    )


def _metrics(pair: PreferredPair, metrics: StudyMetrics | None, protocol: str) -> Table | None:
    """Return the metrics that at least one of the two clips has."""
    found: dict[str, dict[str, MetricResult]] = {}
    for score in () if metrics is None else metrics.clips:
        name = score.result.name
        if score.segment == pair.segment and not is_detail(name, protocol):
            found.setdefault(name, {})[score.condition] = score.result
    scored = {
        name: results
        for name, results in found.items()
        if any(
            not math.isnan(_value(results.get(condition)))
            for condition in (pair.first, pair.second)
        )
    }
    if not scored:
        return None
    rows = []
    for name, results in scored.items():
        one = next(iter(results.values()))
        own = {c: _value(results.get(c)) for c in (pair.first, pair.second)}
        rows.append(
            {"heading": f"{name} {ARROWS[one.better]}".strip(), "unit": one.unit, "of": own}
        )
    return table("metrics-of-pair", rows, pair=pair)


def _value(result: MetricResult | None) -> float:
    return math.nan if result is None else result.value
