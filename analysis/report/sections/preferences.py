"""Preferences as AMUSE shows them, matrices of many conditions, and mismatched speech."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Final, NamedTuple, TypeVar

from analysis.report import wording
from analysis.report.content import FigureText, Picture, Section, Subject, Table, headline_section
from analysis.report.figures.estimates import (
    Bar,
    MatrixCell,
    Part,
    bar_of,
    bar_pictures,
    matrix_pictures,
)
from analysis.report.figures.panels import Row
from analysis.report.figures.style import DIVERGING, Scale
from analysis.report.sections.conditions import (
    standings_table,
    strength_pictures,
    strongest_first,
)
from analysis.report.texts import figure_text, sentence, table
from analysis.report.wording import SIGNIFICANCE, reason_for_no_figure, set_suffix, share_words
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.preference import Comparison, MatchedCondition
from analysis.results.strengths import StrengthModel

MOST_BARS: Final = 15
"""Most comparisons that are drawn as bars; more are drawn as a matrix."""

_SHARES: Final = Scale(
    limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share", line=0.5
)

OWN_AND_OTHER: Final = ("own speech", "other speech")

ResultT = TypeVar("ResultT", Comparison, MatchedCondition)


class PreferenceRow(NamedTuple):
    """The answers to one question about two sides.

    Attributes
    ----------
    label : str
        The row's name within its group.
    names : tuple of str
        The names of both sides.
    result : Comparison or MatchedCondition
        The result, seen from the first side.
    """

    label: str
    names: tuple[str, ...]
    result: Comparison | MatchedCondition

    @property
    def levels(self) -> tuple[int, ...]:
        """Answers: clearly and slightly first, no difference, slightly and clearly second."""
        return tuple(self.result.counts.values())

    @property
    def percentages(self) -> tuple[float, ...]:
        """The levels in percent of all answers; zeros without answers."""
        return tuple(100 * level / max(self.result.n, 1) for level in self.levels)

    @property
    def sides(self) -> tuple[float, ...]:
        """Percent for first, for second and for neither; NaN without answers."""
        return tuple(self.result.share.values())


@dataclass(frozen=True, kw_only=True)
class PreferenceGroup:
    """The rows of one set, which share a figure.

    Attributes
    ----------
    set : str or None
        None without sets.
    first, second : str
        Names of the two sides that fit every row.
    heading : str
        Heading of the column that names the rows.
    data : str
        File in the report's ``tables`` folder with the full results.
    rows : tuple of PreferenceRow
        By question, emotion first as in AMUSE's Figure 6, and then by win share on the first
        question.
    """

    set: str | None
    first: str
    second: str
    heading: str
    data: str
    rows: tuple[PreferenceRow, ...]

    @property
    def labels(self) -> tuple[str, ...]:
        """The labels of the rows, in order."""
        return tuple(dict.fromkeys(row.label for row in self.rows))

    @property
    def questions(self) -> tuple[str, ...]:
        """The questions, in order."""
        return tuple(dict.fromkeys(row.result.question for row in self.rows))

    @property
    def is_graded(self) -> bool:
        """Whether anybody preferred a side clearly; a scale of three levels does not offer it."""
        return any(row.levels[0] or row.levels[4] for row in self.rows)

    def levels(self, first: str, second: str) -> tuple[str, ...]:
        """Return the names of the five answers about two sides."""
        slightly = "slightly " if self.is_graded else ""
        return (
            f"clearly {first}",
            f"{slightly}{first}",
            "no difference",
            f"{slightly}{second}",
            f"clearly {second}",
        )

    @property
    def reason_for_no_figure(self) -> str:
        """Why no figure is drawn, or '' if one can be drawn."""
        answers = sum(row.result.n for row in self.rows)
        is_tied = answers == sum(row.levels[2] for row in self.rows)
        return reason_for_no_figure(
            answers=answers,
            participants=max(row.result.attentive for row in self.rows),
            tied=f"Every one of the {answers} answers is “no difference”: nobody preferred anything"
            if is_tied
            else "",
        )


def pairwise_groups(results: PairwiseResults, reference: str | None) -> tuple[PreferenceGroup, ...]:
    """Return the comparisons of each set, with the reference first if there is one."""
    groups = []
    for comparisons in _by_set(results.comparisons):
        first = reference_of(comparisons, reference)
        rows = [_row(comparison, first) for comparison in comparisons]
        names = ("the first", "the second", "first against second")
        if first is not None:
            names = (wording.condition(first), "the other", "against")
        groups.append(_group(names, "comparisons.csv", rows))
    return tuple(groups)


def _row(comparison: Comparison, reference: str | None) -> PreferenceRow:
    result = comparison.mirrored() if comparison.b == reference else comparison
    label = wording.against(*result.names) if reference is None else wording.condition(result.b)
    return PreferenceRow(label, tuple(map(wording.condition, result.names)), result)


def reference_of(comparisons: Sequence[Comparison], reference: str | None) -> str | None:
    """Return the condition that comes first in all comparisons, or None.

    Parameters
    ----------
    comparisons : sequence of Comparison
        The comparisons of one set.
    reference : str or None
        The study's reference; without it, the condition that all comparisons share, or the first
        of two such conditions.
    """
    candidates = (comparisons[0].a, comparisons[0].b) if reference is None else (reference,)
    common = [name for name in candidates if all(name in (c.a, c.b) for c in comparisons)]
    return common[0] if common else None


def mismatch_groups(results: MismatchResults) -> tuple[PreferenceGroup, ...]:
    """Return the conditions of each set, seen from their own speech."""
    names = (*OWN_AND_OTHER, "condition")
    return tuple(
        _group(
            names,
            "conditions.csv",
            [PreferenceRow(wording.condition(c.condition), OWN_AND_OTHER, c) for c in conditions],
        )
        for conditions in _by_set(results.conditions)
    )


def _by_set(results: Sequence[ResultT]) -> Iterable[list[ResultT]]:
    return (list(of_set) for _, of_set in groupby(results, key=lambda result: result.set))


def _group(
    names: tuple[str, str, str], data: str, rows: Sequence[PreferenceRow]
) -> PreferenceGroup:
    questions = dict.fromkeys(row.result.question for row in rows)
    ordered = sorted(questions, key=lambda question: "emotion" not in question)
    shares = {
        row.label: row.result.win_share.estimate
        for row in rows
        if row.result.question == ordered[0] and row.result.n
    }

    def order(row: PreferenceRow) -> tuple[int, float]:
        return ordered.index(row.result.question), -shares.get(row.label, -1.0)

    first, second, heading = names
    return PreferenceGroup(
        set=rows[0].result.set,
        first=first,
        second=second,
        heading=heading,
        data=data,
        rows=tuple(sorted(rows, key=order)),
    )


def preference_sections(
    results: PairwiseResults | MismatchResults, subject: Subject
) -> Iterator[Section]:
    """Yield one section for each set."""
    if isinstance(results, PairwiseResults):
        for number, group in enumerate(pairwise_groups(results, subject.reference), start=1):
            yield _pairwise_section(results, group, set_suffix(group.set, number))
    else:
        for number, group in enumerate(mismatch_groups(results), start=1):
            yield _mismatch_section(group, set_suffix(group.set, number))


def _pairwise_section(results: PairwiseResults, group: PreferenceGroup, suffix: str) -> Section:
    strengths = results.bradley_terry.of_set(group.set)
    contrasts = [contrast for contrast in results.contrasts if contrast.set == group.set]
    has_reference = group.heading == "against"

    def pictures() -> tuple[Picture, ...]:
        if has_reference or len(group.labels) <= MOST_BARS:
            text = figure_text("preferences", suffix=suffix, group=group)
            drawn = preference_pictures(group, text)
        else:
            text = figure_text("win-share-matrix", suffix=suffix)
            drawn = _matrix_pictures(results, group, text)
        if has_reference:
            return drawn
        text = figure_text("strengths", suffix=suffix)
        fitted = _fitted(results, group)
        return (*drawn, *strength_pictures(fitted, "strength in logits", text))

    tables = _tables(group, "preferences", decisive=results.decided_by == "comparisons")
    if strengths:
        tables.append(standings_table(strengths, "strengths"))
        if len({name for contrast in contrasts for name in contrast.names}) > 2:
            tables.append(
                table(
                    "contrasts",
                    contrasts,
                    fitted=strengths,
                    estimates="strengths",
                    decisive=results.decided_by == "strengths",
                )
            )
    return headline_section(
        group.set,
        suffix,
        "What was preferred",
        no_figure=group.reason_for_no_figure,
        pictures=pictures,
        tables=tables,
    )


def _fitted(results: PairwiseResults, group: PreferenceGroup) -> dict[str, StrengthModel]:
    strengths = results.bradley_terry.of_set(group.set)
    return {question: strengths[question] for question in group.questions if question in strengths}


def _mismatch_section(group: PreferenceGroup, suffix: str) -> Section:
    text = figure_text("preferences", group=group)
    sums, shares, *others = _tables(group, "own-speech")
    return headline_section(
        group.set,
        suffix,
        "Whether the motion fits its own speech",
        no_figure=group.reason_for_no_figure,
        paragraph=sentence("effects.own_speech"),
        pictures=lambda: preference_pictures(group, replace(text, name=f"own-speech{suffix}")),
        tables=(shares, sums, *others),
    )


def _tables(group: PreferenceGroup, name: str, *, decisive: bool = True) -> list[Table]:
    answers = group.levels(group.first, group.second)
    return [
        table("preferences", group.rows, group=group, name=name),
        *(
            table(kind, group.rows, group=group, levels=answers, decisive=decisive)
            for kind in ("win-shares", "counts", "as-published")
        ),
    ]


def preference_pictures(group: PreferenceGroup, text: FigureText) -> tuple[Picture, ...]:
    """Draw answers as bars around 'no difference', with win shares: AMUSE's Figure 6."""
    by_name = {(row.label, row.result.question): row for row in group.rows}
    panels = {
        question: [_bar(group, by_name.get((label, question))) for label in group.labels]
        for question in group.questions
    }
    ends = [
        abs(end)
        for bars in panels.values()
        for bar in bars
        for end in (bar.start, bar.start + sum(part.percent for part in bar.parts))
    ]
    limit = min(100, max(60, math.ceil(max(ends)) + 5))
    participants = {
        label: max(row.result.attentive for row in group.rows if row.label == label)
        for label in group.labels
    }
    legend = list(zip(group.levels(group.first, group.second), DIVERGING, strict=True))
    return bar_pictures(
        panels,
        [Row(label, f"n = {participants[label]}") for label in group.labels],
        dict(legend if group.is_graded else legend[1:-1]),
        Scale(
            limits=(-limit, limit),
            ticks={-50: "50%", 0: "0", 50: "50%"},
            label=f"← {group.first}, {group.second} →",
            line=0,
        ),
        _SHARES,
        text,
    )


def _bar(group: PreferenceGroup, row: PreferenceRow | None) -> Bar:
    if row is None or not row.result.n:
        return Bar()
    percents = row.percentages
    parts = [
        Part(percent, f"{level}: {count} of {row.result.n} answers ({percent:.0f}%)")
        for percent, count, level in zip(
            percents, row.levels, group.levels(*row.names), strict=True
        )
    ]
    return bar_of(
        parts if group.is_graded else parts[1:-1],
        row.result.win_share,
        wording.share,
        start=-(percents[0] + percents[1] + percents[2] / 2),
    )


def _matrix_pictures(
    results: PairwiseResults, group: PreferenceGroup, text: FigureText
) -> tuple[Picture, ...]:
    comparisons = [c for c in results.comparisons if c.set == group.set]
    cells: dict[str, dict[tuple[str, str], MatrixCell]] = {name: {} for name in group.questions}
    for comparison in comparisons:
        if not comparison.n:
            continue
        for side in (comparison, comparison.mirrored()):
            cells[side.question][side.a, side.b] = MatrixCell(
                side.win_share.estimate,
                share_words(side.win_share),
                comparison.decision.p_holm < SIGNIFICANCE,
            )
    names = [name for comparison in comparisons for name in comparison.names]
    return matrix_pictures(cells, strongest_first(_fitted(results, group), names), text)
