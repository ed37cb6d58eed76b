"""Effects by emotion, speaker and segment, as forest plots and tests."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from analysis.report import wording
from analysis.report.content import Picture, Section, Subject, Table
from analysis.report.figures.estimates import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.sections.preferences import reference_of
from analysis.report.texts import figure_text, paragraphs, table
from analysis.results.conditions import RankingResults, RatingResults
from analysis.results.grouping import ResultKey
from analysis.results.heterogeneity import FEW, KINDS, By, ConditionHeterogeneity, PairHeterogeneity
from analysis.results.heterogeneity import Cell as Level
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.report import Results, TableReport
from analysis.stats.clustered_mean import Estimate

MOST_PANELS: Final = 24
"""Most effects for which forest plots are drawn; more are only in the tables."""

MOST_ROWS: Final = 26
"""Most levels with which a forest plot fits on a page."""

_OVERALL: Final = {"emotion": "all emotions", "speaker": "all speakers", "segment": "all segments"}


@dataclass(frozen=True, kw_only=True)
class _Measure:
    """The axis of one kind of effect, its name in a caption, and how its numbers are written."""

    scale: Scale
    name: str
    formatted: Callable[[float], str]


_MEASURES: Final = {
    "win_share": _Measure(
        scale=Scale(
            limits=(0, 1),
            ticks={0: "0", 0.25: ".25", 0.5: ".5", 0.75: ".75", 1: "1"},
            label="win share",
        ),
        name="win share, .5 for no preference",
        formatted=wording.share,
    ),
    "difference": _Measure(
        scale=Scale(label="difference in scores"),
        name="mean difference of paired ratings in scores, 0 for none",
        formatted=wording.number,
    ),
    "mean_rank": _Measure(
        scale=Scale(label="mean rank"), name="mean rank, 1 is best", formatted=wording.number
    ),
}


def heterogeneity_section(report: TableReport, subject: Subject) -> Section | None:
    """Return forest plots and tests; None for one segment, or one participant."""
    all_effects = effects(report.results, subject.reference)
    if not all_effects or report.participants.attentive < 2:
        return None
    by_kind = {
        by: chosen for by in KINDS if (chosen := [e for e in all_effects if e.result.by == by])
    }
    # Where each emotion has one segment, the figure by segment shows the same numbers.
    repeated = [
        by
        for by, chosen in by_kind.items()
        if by != "segment" and all(level.segments == 1 for e in chosen for level in e.result.levels)
    ]
    missing = [
        by
        for by, chosen in by_kind.items()
        if by not in repeated and (len(chosen) > MOST_PANELS or len(_levels(chosen)) > MOST_ROWS)
    ]
    drawn = [by for by in by_kind if by not in repeated + missing]
    return Section(
        anchor="heterogeneity",
        heading="Where the difference comes from",
        paragraphs=paragraphs(
            "effects.section",
            descriptive=any(level.descriptive for e in all_effects for level in e.result.levels),
            few=FEW,
            repeated=repeated,
            missing=missing,
        ),
        pictures=tuple(picture for by in drawn for picture in _forest(by_kind[by], by)),
        tables=(_tests(all_effects),),
    )


def _tests(all_effects: Sequence[Effect]) -> Table:
    """Return the tests that could be run; if none could, a folded table says why."""
    tested = [effect for effect in all_effects if not math.isnan(effect.result.test.p_value)]
    tests_table = table("heterogeneity-tests", tested or all_effects, all_effects=all_effects)
    return tests_table if tested else replace(tests_table, secondary="No test could be run")


class Effect(NamedTuple):
    """One effect by emotion, speaker or segment, its label, and the estimate over all of them."""

    label: str
    result: PairHeterogeneity | ConditionHeterogeneity
    overall: Estimate | None

    @property
    def heading(self) -> str:
        """The panel's heading."""
        prefix = "" if self.result.set is None else f"Set {self.result.set}, "
        return f"{prefix}{wording.name(self.result.question)}: {self.label}"


def effects(results: Results, reference: str | None) -> tuple[Effect, ...]:
    """Return all effects by emotion, speaker and segment.

    Parameters
    ----------
    results : PairwiseResults, RatingResults, RankingResults or MismatchResults
        The report's results.
    reference : str or None
        The condition that comes first in its pairs, if any.
    """
    overall = overall_effects(results)
    comparisons = results.comparisons if isinstance(results, PairwiseResults) else ()
    references = {
        name: reference_of([c for c in comparisons if c.set == name], reference)
        for name in dict.fromkeys(c.set for c in comparisons)
    }
    return tuple(
        _effect(result, overall.get(_key(result)), references.get(result.set))
        for result in results.heterogeneity
    )


def _effect(
    result: PairHeterogeneity | ConditionHeterogeneity,
    overall: Estimate | None,
    reference: str | None,
) -> Effect:
    if isinstance(result, ConditionHeterogeneity):
        return Effect(wording.condition(result.condition), result, overall)
    if result.b != reference:
        return Effect(wording.against(result.a, result.b), result, overall)
    mirrored = replace(result, levels=tuple(level.mirrored() for level in result.levels))
    label = wording.against(result.b, result.a)
    return Effect(label, mirrored, None if overall is None else overall.mirrored())


Key = tuple[str | None, str, tuple[str, ...]]
"""Set, question and conditions."""


def _key(place: ResultKey) -> Key:
    return place.set, place.question, place.names


def overall_effects(results: Results) -> dict[Key, Estimate]:
    """Return the estimates that a report's headline rests on."""
    match results:
        case PairwiseResults():
            return {_key(c): c.win_share for c in results.comparisons}
        case RatingResults():
            return {_key(c): c.difference for c in results.contrasts}
        case RankingResults():
            return {_key(c): c.mean_rank for c in results.conditions}
        case MismatchResults():
            return {_key(c): c.win_share for c in results.conditions}


def _levels(effects: Sequence[Effect]) -> list[str]:
    """Return the names of all levels, 's2' before 's10'."""
    names = {level.level for effect in effects for level in effect.result.levels}
    return sorted(
        names,
        key=lambda name: [
            (int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)
        ],
    )


def _forest(effects: Sequence[Effect], by: By) -> tuple[Picture, ...]:
    names = _levels(effects)
    measure = _MEASURES[effects[0].result.measure]
    return dot_pictures(
        {effect.heading: _dots(effect, names, measure.formatted) for effect in effects},
        [*(Row(wording.name(name)) for name in names), Row(_OVERALL[by])],
        replace(measure.scale, line=effects[0].result.null),
        figure_text("by", suffix=f"-{by}", by=by, measure=measure.name, few=FEW),
    )


def _dots(effect: Effect, names: Sequence[str], formatted: Callable[[float], str]) -> list[Dot]:
    levels = {level.level: level for level in effect.result.levels}
    dots = [_dot(levels.get(name), formatted) for name in names]
    return [*dots, replace(_dot(effect.overall, formatted), is_overall=True)]


def _dot(estimate: Estimate | None, formatted: Callable[[float], str]) -> Dot:
    segments = "" if estimate is None else f", {wording.count(estimate.segments, 'segment')}"
    return replace(
        dot_of(estimate, formatted, more=segments, missing="no answers"),
        is_descriptive=isinstance(estimate, Level) and estimate.descriptive,
    )
