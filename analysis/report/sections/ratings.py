"""Ratings as the user study of Speech2UnifiedExpressions shows them, and every contrast."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture, Section, Table, headline_section
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.dots import Dot, dot_of, dot_pictures
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import LINE, SMALL_SIZE, Scale, scale_colours, sign_of
from analysis.report.subject import Subject
from analysis.report.texts import about, table
from analysis.report.wording import number, suffix, why_no_figure
from analysis.results.rating import RatedCondition, RatingContrast, RatingResults

MOST_PAIRS: Final = 15
"""Pairs of conditions up to which their differences are drawn."""


def rating_sections(results: RatingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set; the subject names the points of the scales."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject, suffix(name, place)) for place, name in enumerate(sets, 1)
    )


def _section(results: RatingResults, name: str | None, subject: Subject, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    contrasts = [c for c in results.contrasts if c.set == name]
    tables = [_scores(conditions), table("means", conditions)]
    if contrasts:
        tables.append(table("rating-contrasts", contrasts))
        tables.append(table("model", contrasts, models=results.clmm.of_set(name)))

    def pictures() -> tuple[Picture, ...]:
        labels, mark = subject.scale_labels, subject.mark
        few = 0 < len(contrasts) <= MOST_PAIRS * len({c.question for c in contrasts})
        return (
            *distribution_pictures(conditions, labels, end=end, mark=mark),
            *_cumulative_pictures(conditions, end, mark),
            *(_contrast_pictures(contrasts, end, mark) if few else ()),
        )

    given = {score for c in conditions for score, count in c.counts.items() if count}
    return headline_section(
        name,
        end,
        "How the conditions were rated",
        reason=why_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.participants for c in conditions),
            tied=f"Every rating is {given.pop()}: nothing tells the conditions apart, so there is "
            "nothing to draw and nothing to test."
            if len(given) == 1
            else "",
        ),
        pictures=pictures,
        tables=tables,
    )


def _scores(conditions: Sequence[RatedCondition]) -> Table:
    """Return the table of means, the best and the second best marked, as they are shown."""
    shown: dict[str, list[float]] = {}
    for c in conditions:
        if not math.isnan(c.estimate):
            shown.setdefault(c.question, []).append(round(c.estimate, 2))
    ranked = {question: sorted(set(means), reverse=True) for question, means in shown.items()}
    best, second = (
        [
            c
            for c in conditions
            if ranked.get(c.question, [])[1:] and round(c.estimate, 2) == ranked[c.question][place]
        ]
        for place in (0, 1)
    )
    return table("scores", conditions, best=best, second=second)


def distribution_pictures(
    conditions: Sequence[RatedCondition],
    labels: Mapping[str, Sequence[str]],
    *,
    end: str = "",
    mark: str = "",
) -> tuple[Picture, ...]:
    """Draw how often each score was given, with means beside: S2UE's Figure 6.

    Parameters
    ----------
    conditions : sequence of RatedCondition
        Of one set.
    labels : mapping of str to sequence of str
        By question, what its scores are called, worst first; the legend says so where all
        questions agree, and otherwise the caption.
    end, mark
        See `analysis.report.texts.about`.
    """
    scores = tuple(conditions[0].counts)
    questions = tuple(dict.fromkeys(c.question for c in conditions))
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    by_place = {(c.condition, c.question): c for c in conditions}
    ratings = {one: max(c.n for c in conditions if c.condition == one) for one in names}
    called = {question: tuple(labels.get(question, ())) for question in questions}
    own, *others = set(called.values())
    words = [str(score) for score in scores]
    if len(own) == len(scores) and not others:
        words = [f"{score} {label}" for score, label in zip(scores, own, strict=True)]
    else:
        words[0], words[-1] = f"{words[0]} (worst)", f"{words[-1]} (best)"
    said = {name: own for name, own in called.items() if others and len(own) == len(scores)}
    ends = (scores[0], scores[-1])
    return bar_pictures(
        {
            question: [_bar(by_place.get((one, question))) for one in names]
            for question in questions
        },
        [Row(wording.condition(one), f"n = {ratings[one]}") for one in names],
        dict(zip(words, scale_colours(len(scores)), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of ratings"),
        Scale(limits=ends, ticks={score: str(score) for score in ends}, label="mean"),
        about("ratings", end=end, mark=mark, called=said, scores=scores),
    )


def _bar(rated: RatedCondition | None) -> Bar:
    if rated is None or not rated.n:
        return Bar()
    shares = [(score, count, 100 * count / rated.n) for score, count in rated.counts.items()]
    return Bar(
        parts=tuple(
            Part(percent, colour, f"score {score}: {count} of {rated.n} ratings ({percent:.0f}%)")
            for (score, count, percent), colour in zip(
                shares, scale_colours(len(shares)), strict=True
            )
        ),
        beside=rated,
    )


def _cumulative_pictures(
    conditions: Sequence[RatedCondition], end: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how many ratings reach each score, a line per condition: S2UE's Figure 7."""
    scores = tuple(conditions[0].counts)
    by_place = {(c.condition, c.question): c for c in conditions}
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    scale = Scale(
        limits=(scores[0] - 0.1, scores[-1] + 0.1),
        ticks={score: str(score) for score in scores[:: max(1, len(scores) // 10)]},
        label="score or higher",
    )

    def draw(panel: Panel, question: str) -> Hints:
        axes = panel.axes[0]
        for place, one in enumerate(names):
            if rated := by_place.get((one, question)):
                axes.add_line(_curve(place, rated.at_least))
        scale.dress(axes, panel.inches)
        axes.set_ylim(0, 104)
        axes.set_yticks([0, 50, 100], labels=["0", "50", "100%"] if panel.is_first else [""] * 3)
        axes.tick_params(axis="y", length=0, labelsize=SMALL_SIZE)
        axes.grid(axis="y", color=LINE, linewidth=0.5)
        return {}

    told = {
        question: f"{wording.heading(question)}. "
        + "; ".join(
            f"{wording.condition(c.condition)}: {_reached(c)}"
            for c in conditions
            if c.question == question
        )
        + "."
        for question in dict.fromkeys(c.question for c in conditions)
    }
    legend = [_curve(place, {}, wording.condition(one)) for place, one in enumerate(names)]
    return panel_pictures(
        PanelFigure(told=told, draw=draw, height=1.9, legend=legend),
        about("cumulative", end=end, mark=mark),
    )


def _curve(place: int, at_least: Mapping[int, float], label: str = "") -> Line2D:
    colour, marker = sign_of(place)
    return Line2D(
        *(list(at_least), list(at_least.values())),
        color=colour,
        linestyle=("-", "--", ":")[place // 3 % 3],
        marker=marker,
        markersize=4,
        linewidth=1.3,
        label=label,
    )


def _reached(rated: RatedCondition) -> str:
    return ", ".join(
        f"{percent:.0f}% at least {score}" for score, percent in rated.at_least.items()
    )


def _contrast_pictures(
    contrasts: Sequence[RatingContrast], end: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how much better each condition is rated than each other one, in scores."""
    pairs = list(dict.fromkeys((c.a, c.b) for c in contrasts))
    by_place = {(c.a, c.b, c.question): c for c in contrasts}
    return dot_pictures(
        {
            question: [_difference(by_place.get((a, b, question))) for a, b in pairs]
            for question in dict.fromkeys(c.question for c in contrasts)
        },
        [Row(wording.against(a, b)) for a, b in pairs],
        Scale(label="difference in scores", line=0.0),
        about("contrasts", end=end, mark=mark),
    )


def _difference(contrast: RatingContrast | None) -> Dot:
    if contrast is None:
        return dot_of(None, number)
    p = contrast.difference.p_holm
    below = "no test" if math.isnan(p) else wording.p_is(p)
    more = f", p (Holm) {wording.p_value(p)}"
    return dot_of(contrast.difference, number, below=below, more=more)
