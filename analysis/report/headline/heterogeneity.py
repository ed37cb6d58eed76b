"""Where a difference comes from: effects by emotion, speaker and segment, as forest plots."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Final

from analysis.report import wording
from analysis.report.content import Picture, Section, Table, cells
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Row, Scale
from analysis.report.figures.svg import About
from analysis.report.headline.apart import Apart, taken_apart
from analysis.report.headline.words import between, count_cell, counted, number, number_cell, p_cell
from analysis.report.subject import Subject
from analysis.results.heterogeneity import KINDS, By
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL, Estimate
from analysis.stats.heterogeneity import FEW, Cell

MOST_PANELS: Final = 24
"""Effects up to which forest plots are drawn; more of them stand in the tables alone."""

MOST_ROWS: Final = 26
"""Levels up to which a forest plot fits a page."""

_ALL: Final = {"emotion": "all emotions", "speaker": "all speakers", "segment": "all segments"}
_DATA: Final = "heterogeneity.csv"


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
    found = taken_apart(report.results, subject.reference)
    if not found:
        return None
    few = any(level.descriptive for one in found for level in one.levels)
    missing = [by for by in KINDS if any(one.by == by for one in found) and not _drawn(found, by)]
    paragraphs = [
        "These estimates show where a difference comes from. Whether there is one, the headline "
        "tests; that one emotion, speaker or segment decides and another does not is no evidence "
        "that they differ: the tests of the table ask that."
    ]
    if few:
        paragraphs.append(
            f"Hollow marks are descriptive: they rest on {FEW} segments or fewer, which says "
            "nothing about others of their kind, so they are not tested."
        )
    if missing:
        paragraphs.append(
            f"By {' and by '.join(missing)} there are too many estimates to draw; they are in "
            f"tables/{_DATA}."
        )
    return Section(
        anchor="heterogeneity",
        heading="Where the difference comes from",
        paragraphs=tuple(paragraphs),
        pictures=tuple(
            picture
            for by in KINDS
            if _drawn(found, by)
            for picture in _forest(found, by, subject.mark)
        ),
        tables=(_tests(found),),
    )


def _drawn(found: Sequence[Apart], by: By) -> bool:
    of = [one for one in found if one.by == by]
    return 0 < len(of) <= MOST_PANELS and len(_levels(of)) <= MOST_ROWS


def _levels(found: Sequence[Apart]) -> tuple[str, ...]:
    return tuple(sorted({level.level for one in found for level in one.levels}, key=_natural))


def _natural(name: str) -> list[tuple[int, str]]:
    """Return a key that puts 's2' before 's10'."""
    return [
        (int(part), "") if part.isdecimal() else (-1, part) for part in re.split(r"(\d+)", name)
    ]


def _forest(found: Sequence[Apart], by: By, mark: str) -> tuple[Picture, ...]:
    of = [one for one in found if one.by == by]
    names = _levels(of)
    measure = _MEASURES[of[0].measure]
    return dot_pictures(
        {one.heading: _dots(one, names, measure) for one in of},
        [*(Row(wording.name(name)) for name in names), Row(_ALL[by])],
        replace(measure.scale, line=of[0].null),
        About(
            name=f"by-{by}",
            title=f"Effects by {by}",
            caption=f"By {by}: {measure.says}, with {LEVEL:.0%} intervals, clustered by "
            "participant and segment, of one segment by participant alone; after exclusions. "
            f"Hollow: descriptive, {FEW} segments or fewer. Diamond: over all.",
            data=_DATA,
            mark=mark,
        ),
    )


def _dots(of: Apart, names: Sequence[str], measure: _Measure) -> list[Dot]:
    by_name = {level.level: level for level in of.levels}
    dots = [_dot(by_name.get(name), measure) for name in names]
    return [*dots, _dot(of.whole, measure, whole=True)]


def _dot(found: Estimate | None, measure: _Measure, *, whole: bool = False) -> Dot:
    if found is None or not found.n:
        return Dot(words="–", hint="no answers", whole=whole)
    written = measure.written(found.estimate)
    inside = (
        f"no interval: {found.reason}"
        if found.reason
        else between(measure.written(found.low), measure.written(found.high))
    )
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        words=written,
        hint=f"{written} {inside}, {wording.count(found.segments, 'segment')}",
        descriptive=isinstance(found, Cell) and found.descriptive,
        whole=whole,
    )


def _tests(found: Sequence[Apart]) -> Table:
    return Table(
        caption="Whether effects differ between emotions, speakers or segments. p (Holm) is "
        "corrected over these tests of the report, which are exploratory.",
        header=(
            *("question", "of", "by", "levels", "F", "df", "p"),
            f"p{wording.NO_BREAK}(Holm)",
        ),
        rows=tuple(
            (
                *cells(_question(one), one.about, one.by),
                count_cell(len(one.levels)),
                number_cell(one.test.statistic),
                counted(one.test.df, _freedom(one)),
                p_cell(one.test.p_value),
                p_cell(one.test.p_holm),
            )
            for one in found
        ),
        text_columns=3,
        notes=tuple(
            dict.fromkeys(
                f"By {one.by}: {text.rstrip('.')}."
                for one in found
                for text in (one.test.method, one.test.reason and f"no test, {one.test.reason}")
                if text
            )
        ),
        name="heterogeneity-tests",
    )


def _question(one: Apart) -> str:
    of = "" if one.set is None else f"Set {one.set}: "
    return f"{of}{wording.heading(one.question)}"


def _freedom(one: Apart) -> str:
    if math.isnan(one.test.df):
        return "–"
    return f"{wording.fixed(one.test.df, 0)}, {wording.fixed(one.test.df_rest, 1)}"
