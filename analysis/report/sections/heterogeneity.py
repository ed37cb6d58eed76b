"""Where a difference comes from: effects by emotion, speaker and segment, as forest plots."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final, NamedTuple

from analysis.report import wording
from analysis.report.content import Picture, Section
from analysis.report.figures.dots import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Row
from analysis.report.figures.style import Scale
from analysis.report.sections.preferences import reference_of
from analysis.report.subject import Subject
from analysis.report.texts import about, paragraphs, table
from analysis.report.wording import number
from analysis.results.grouping import ResultKey
from analysis.results.heterogeneity import (
    FEW,
    KINDS,
    By,
    ConditionHeterogeneity,
    PairHeterogeneity,
)
from analysis.results.heterogeneity import Cell as Level
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.rating import RatingResults
from analysis.results.report import Results, TableReport
from analysis.stats.clustered_mean import Estimate

MOST_PANELS: Final = 24
"""Effects up to which forest plots are drawn; more of them stand in the tables alone."""

MOST_ROWS: Final = 26
"""Levels up to which a forest plot fits a page."""

_ALL: Final = {"emotion": "all emotions", "speaker": "all speakers", "segment": "all segments"}


@dataclass(frozen=True, kw_only=True)
class _Measure:
    """How effects of one kind are called and written."""

    scale: Scale
    says: str
    written: Callable[[float], str]


_MEASURES: Final = {
    "win_share": _Measure(
        scale=Scale(
            limits=(0, 1),
            ticks={0: "0", 0.25: ".25", 0.5: ".5", 0.75: ".75", 1: "1"},
            label="win share",
        ),
        says="win share, .5 for no preference",
        written=wording.share,
    ),
    "difference": _Measure(
        scale=Scale(label="difference in scores"),
        says="mean difference of paired ratings in scores, 0 for none",
        written=number,
    ),
    "mean_rank": _Measure(
        scale=Scale(label="mean rank"), says="mean rank, 1 is best", written=number
    ),
}


def heterogeneity_section(report: TableReport, subject: Subject) -> Section | None:
    """Return forest plots and tests, None where neither emotions nor speakers nor segments differ.

    Parameters
    ----------
    report : TableReport
        What was found.
    subject : Subject
        Its reference, if it has one, is what pairwise win shares are seen from.
    """
    found = effects(report.results, subject.reference)
    if not found:
        return None
    there = [by for by in KINDS if any(one.found.by == by for one in found)]
    drawn = [by for by in there if _drawn(found, by)]
    return Section(
        anchor="heterogeneity",
        heading="Where the difference comes from",
        paragraphs=paragraphs(
            "effects.section",
            descriptive=any(level.descriptive for one in found for level in one.found.levels),
            few=FEW,
            missing=[by for by in there if by not in drawn],
        ),
        pictures=tuple(one for by in drawn for one in _forest(found, by, subject.mark)),
        tables=(table("heterogeneity-tests", found),),
    )


class Effect(NamedTuple):
    """One effect by emotion, speaker or segment, what it is the effect of, and over all of them."""

    about: str
    found: PairHeterogeneity | ConditionHeterogeneity
    whole: Estimate | None

    @property
    def heading(self) -> str:
        """What heads its panel."""
        of = "" if self.found.set is None else f"Set {self.found.set}, "
        return f"{of}{wording.name(self.found.question)}: {self.about}"


def effects(results: Results, reference: str | None) -> tuple[Effect, ...]:
    """Return all of a report's effects by emotion, speaker and segment.

    Parameters
    ----------
    results : PairwiseResults, RatingResults, RankingResults or MismatchResults
        What was found.
    reference : str or None
        The condition from whose side pairwise win shares are seen, where there is one.
    """
    wholes = whole_effects(results)
    comparisons = results.comparisons if isinstance(results, PairwiseResults) else ()
    from_side = {
        name: reference_of([c for c in comparisons if c.set == name], reference)
        for name in dict.fromkeys(c.set for c in comparisons)
    }
    return tuple(
        _effect(one, wholes.get(_key(one)), from_side.get(one.set)) for one in results.heterogeneity
    )


def _effect(
    found: PairHeterogeneity | ConditionHeterogeneity, whole: Estimate | None, side: str | None
) -> Effect:
    if isinstance(found, ConditionHeterogeneity):
        return Effect(wording.condition(found.condition), found, whole)
    if found.b != side:
        return Effect(wording.against(found.a, found.b), found, whole)
    turned = replace(found, levels=tuple(level.mirrored() for level in found.levels))
    about = wording.against(found.b, found.a)
    return Effect(about, turned, None if whole is None else whole.mirrored())


Key = tuple[str | None, str, tuple[str, ...]]
"""Set, question and conditions."""


def _key(one: ResultKey) -> Key:
    return one.set, one.question, one.names


def whole_effects(results: Results) -> dict[Key, Estimate]:
    """Return the estimates that a report's headline rests on."""
    match results:
        case PairwiseResults():
            return {_key(one): one.win_share for one in results.comparisons}
        case RatingResults():
            return {_key(one): one.difference for one in results.contrasts}
        case RankingResults():
            return {_key(one): one.mean_rank for one in results.conditions}
        case MismatchResults():
            return {_key(one): one.win_share for one in results.conditions}


def _drawn(found: Sequence[Effect], by: By) -> bool:
    of = [one for one in found if one.found.by == by]
    return 0 < len(of) <= MOST_PANELS and len(_levels(of)) <= MOST_ROWS


def _levels(found: Sequence[Effect]) -> tuple[str, ...]:
    return tuple(sorted({level.level for one in found for level in one.found.levels}, key=_natural))


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a key that puts 's2' before 's10'."""
    return [
        (int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)
    ]


def _forest(found: Sequence[Effect], by: By, mark: str) -> tuple[Picture, ...]:
    of = [one for one in found if one.found.by == by]
    names = _levels(of)
    measure = _MEASURES[of[0].found.measure]
    return dot_pictures(
        {one.heading: _dots(one, names, measure.written) for one in of},
        [*(Row(wording.name(name)) for name in names), Row(_ALL[by])],
        replace(measure.scale, line=of[0].found.null),
        about("by", end=f"-{by}", mark=mark, by=by, says=measure.says, few=FEW),
    )


def _dots(of: Effect, names: Sequence[str], written: Callable[[float], str]) -> list[Dot]:
    by_name = {level.level: level for level in of.found.levels}
    levels = [by_name.get(name) for name in names]
    return [
        replace(
            dot_of(one, written, more=_segments(one), missing="no answers"),
            descriptive=isinstance(one, Level) and one.descriptive,
            whole=place == len(levels),
        )
        for place, one in enumerate([*levels, of.whole])
    ]


def _segments(found: Estimate | None) -> str:
    return "" if found is None else f", {wording.count(found.segments, 'segment')}"
