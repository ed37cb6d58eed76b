"""Ratings as Speech2UnifiedExpressions shows them, and pairwise differences."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture, Section, Subject, Table, headline_section
from analysis.report.figures.bars import Bar, Part, bar_pictures, condition_bars
from analysis.report.figures.dots import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import LINE, SMALL_SIZE, Scale, scale_colours, series_style
from analysis.report.texts import figure_text, table
from analysis.report.wording import number, reason_for_no_figure, set_suffix
from analysis.results.rating import RatedCondition, RatingContrast, RatingResults

MOST_PAIRS: Final = 15
"""Pairs of conditions up to which their differences are drawn."""


def rating_sections(results: RatingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject, set_suffix(name, number))
        for number, name in enumerate(sets, start=1)
    )


def _section(
    results: RatingResults, set_name: str | None, subject: Subject, suffix: str
) -> Section:
    conditions = [c for c in results.conditions if c.set == set_name]
    contrasts = [c for c in results.contrasts if c.set == set_name]
    tables = [_scores(conditions), table("means", conditions)]
    if contrasts:
        tables.append(table("rating-contrasts", contrasts))
        tables.append(table("model", contrasts, models=results.clmm.of_set(set_name)))

    def pictures() -> tuple[Picture, ...]:
        labels, mark = subject.scale_labels, subject.mark
        questions = {c.question for c in contrasts}
        draws_contrasts = 0 < len(contrasts) <= MOST_PAIRS * len(questions)
        return (
            *distribution_pictures(conditions, labels, suffix=suffix, mark=mark),
            *_cumulative_pictures(conditions, suffix, mark),
            *(_contrast_pictures(contrasts, suffix, mark) if draws_contrasts else ()),
        )

    scores = {score for c in conditions for score, count in c.counts.items() if count}
    return headline_section(
        set_name,
        suffix,
        "How the conditions were rated",
        no_figure=reason_for_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.participants for c in conditions),
            tied=f"Every rating is {scores.pop()}: nothing tells the conditions apart, so there is "
            "nothing to draw and nothing to test."
            if len(scores) == 1
            else "",
        ),
        pictures=pictures,
        tables=tables,
    )


def _scores(conditions: Sequence[RatedCondition]) -> Table:
    """Return the table of means, the best and the second best as printed marked."""
    printed: dict[str, set[float]] = {}
    for c in conditions:
        if not math.isnan(c.estimate):
            printed.setdefault(c.question, set()).add(round(c.estimate, 2))
    ranked = {q: sorted(means, reverse=True) for q, means in printed.items() if len(means) > 1}
    best, second = (
        [
            c
            for c in conditions
            if c.question in ranked and round(c.estimate, 2) == ranked[c.question][place]
        ]
        for place in (0, 1)
    )
    return table("scores", conditions, best=best, second=second)


def distribution_pictures(
    conditions: Sequence[RatedCondition],
    labels: Mapping[str, Sequence[str]],
    *,
    suffix: str = "",
    mark: str = "",
) -> tuple[Picture, ...]:
    """Draw how often each score was given, with means: S2UE's Figure 6.

    Parameters
    ----------
    conditions : sequence of RatedCondition
        Of one set.
    labels : mapping of str to sequence of str
        By question, the labels of its scores, worst first; they are in the legend if all questions
        have the same ones, otherwise in the caption.
    suffix, mark
        See `analysis.report.texts.figure_text`.
    """
    scores = tuple(conditions[0].counts)
    by_question = {c.question: tuple(labels.get(c.question, ())) for c in conditions}
    first, *others = set(by_question.values())
    legend = [str(score) for score in scores]
    if len(first) == len(scores) and not others:
        legend = [f"{score} {label}" for score, label in zip(scores, first, strict=True)]
    else:
        legend[0], legend[-1] = f"{legend[0]} (worst)", f"{legend[-1]} (best)"
    in_caption = {
        q: words for q, words in by_question.items() if others and len(words) == len(scores)
    }
    ends = (scores[0], scores[-1])
    panels, rows = condition_bars(conditions, dict.fromkeys(c.condition for c in conditions), _bar)
    return bar_pictures(
        panels,
        rows,
        dict(zip(legend, scale_colours(len(scores)), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of ratings"),
        Scale(limits=ends, ticks={score: str(score) for score in ends}, label="mean"),
        figure_text(
            "ratings", suffix=suffix, mark=mark, labels_by_question=in_caption, scores=scores
        ),
    )


def _bar(rated: RatedCondition) -> Bar:
    shares = [(score, count, 100 * count / rated.n) for score, count in rated.counts.items()]
    return Bar(
        parts=tuple(
            Part(percent, colour, f"score {score}: {count} of {rated.n} ratings ({percent:.0f}%)")
            for (score, count, percent), colour in zip(
                shares, scale_colours(len(shares)), strict=True
            )
        ),
        estimate=rated,
    )


def _cumulative_pictures(
    conditions: Sequence[RatedCondition], suffix: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how many ratings reach each score, a line per condition: S2UE's Figure 7."""
    scores = tuple(conditions[0].counts)
    by_name = {(c.condition, c.question): c for c in conditions}
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    scale = Scale(
        limits=(scores[0] - 0.1, scores[-1] + 0.1),
        ticks={score: str(score) for score in scores[:: max(1, len(scores) // 10)]},
        label="score or higher",
    )

    def draw(panel: Panel, question: str) -> Hints:
        axes = panel.axes[0]
        for index, name in enumerate(names):
            if rated := by_name.get((name, question)):
                axes.add_line(_curve(index, rated.at_least))
        scale.apply(axes, panel.inches)
        axes.set_ylim(0, 104)
        axes.set_yticks([0, 50, 100], labels=["0", "50", "100%"] if panel.is_first else [""] * 3)
        axes.tick_params(axis="y", length=0, labelsize=SMALL_SIZE)
        axes.grid(axis="y", color=LINE, linewidth=0.5)
        return {}

    descriptions = {
        question: [
            f"{wording.condition(c.condition)}: "
            + ", ".join(f"{percent:.0f}% at least {score}" for score, percent in c.at_least.items())
            for c in conditions
            if c.question == question
        ]
        for question in dict.fromkeys(c.question for c in conditions)
    }
    legend = [_curve(index, {}, wording.condition(name)) for index, name in enumerate(names)]
    return panel_pictures(
        PanelFigure(descriptions=descriptions, draw=draw, height=1.9, legend=legend),
        figure_text("cumulative", suffix=suffix, mark=mark),
    )


def _curve(index: int, at_least: Mapping[int, float], label: str = "") -> Line2D:
    colour, marker = series_style(index)
    return Line2D(
        *(list(at_least), list(at_least.values())),
        color=colour,
        linestyle=("-", "--", ":")[index // 3 % 3],
        marker=marker,
        markersize=4,
        linewidth=1.3,
        label=label,
    )


def _contrast_pictures(
    contrasts: Sequence[RatingContrast], suffix: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how much better the first condition of each pair is rated, in scores."""
    pairs = list(dict.fromkeys((c.a, c.b) for c in contrasts))
    by_pair = {(c.a, c.b, c.question): c for c in contrasts}
    return dot_pictures(
        {
            question: [_dot(by_pair.get((a, b, question))) for a, b in pairs]
            for question in dict.fromkeys(c.question for c in contrasts)
        },
        [Row(wording.against(a, b)) for a, b in pairs],
        Scale(label="difference in scores", line=0.0),
        figure_text("contrasts", suffix=suffix, mark=mark),
    )


def _dot(contrast: RatingContrast | None) -> Dot:
    if contrast is None:
        return dot_of(None, number)
    p = contrast.difference.p_holm
    below = "no test" if math.isnan(p) else wording.p_is(p)
    more = f", p (Holm) {wording.p_value(p)}"
    return dot_of(contrast.difference, number, below=below, more=more)
