"""Ratings as the user study of Speech2UnifiedExpressions shows them: its Figures 6 and 7."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final, Literal

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.bar_figure import Bar, BarFigure, Part, bar_pictures
from analysis.report.figures.dot_figure import Dot, dot_pictures, round_ticks, spread
from analysis.report.figures.ink import LINE, SERIES, scale_colours
from analysis.report.figures.panel_figure import PanelFigure, panel_pictures
from analysis.report.figures.panels import SMALL_SIZE, Place, RowName, Scale, dress
from analysis.report.figures.sheet import Sheet
from analysis.report.headline.words import between, number, of_set
from analysis.results.rating import RatedCondition
from analysis.results.rating_contrasts import RatingContrast
from analysis.stats.clustered_mean import LEVEL

_MARKERS: Final = "osD^vP*X<>hd"
_LINES: Final[tuple[Literal["-", "--", "-.", ":"], ...]] = ("-", "--", "-.", ":")


def distribution_pictures(
    conditions: Sequence[RatedCondition],
    labels: Mapping[str, Sequence[str]],
    *,
    name: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw how often each score was given, with means beside: one panel per question.

    Parameters
    ----------
    conditions : sequence of RatedCondition
        Of one set.
    labels : mapping of str to sequence of str
        By question, what its scores are called, worst first; the legend says so where all
        questions agree.
    name, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    scores = tuple(conditions[0].counts)
    questions, names = _questions(conditions), _names(conditions)
    by_place = {(c.condition, c.question): c for c in conditions}
    figure = BarFigure(
        panels={
            question: tuple(_bar(by_place.get((one, question))) for one in names)
            for question in questions
        },
        told={question: _given(conditions, question) for question in questions},
        rows=tuple(
            RowName(name=wording.name(one), below=f"n = {_ratings(conditions, one)}")
            for one in names
        ),
        colours=scale_colours(len(scores)),
        legend=_legend(scores, [tuple(labels.get(question, ())) for question in questions]),
        bars=Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of ratings"),
        estimates=Scale(
            limits=(scores[0], scores[-1]),
            ticks={score: str(score) for score in (scores[0], scores[-1])},
            label="mean",
        ),
    )
    return bar_pictures(
        figure,
        name=name,
        title="How often each score was given",
        caption=f"{of_set(conditions[0].set)}"
        "How often each score was given, in % of a condition's n ratings, worst on the "
        "left; after exclusions. Right: mean with its "
        f"{LEVEL:.0%} interval, clustered by participant and segment."
        f"{_scales(scores, labels, questions)}",
        data=data,
        mark=mark,
    )


def cumulative_pictures(
    conditions: Sequence[RatedCondition], *, name: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how many ratings reach each score, one panel per question and a line per condition."""
    questions, names = _questions(conditions), _names(conditions)
    scores = tuple(conditions[0].counts)
    by_place = {(c.condition, c.question): c for c in conditions}
    scale = Scale(
        limits=(scores[0] - 0.1, scores[-1] + 0.1),
        ticks={score: str(score) for score in _few(scores)},
        label="score or higher",
    )

    def draw(sheet: Sheet, place: Place, question: str) -> dict[str, str]:
        axes = sheet.panel(place.left, place.top, place.width, place.height)
        dress(axes, 1, scale)
        axes.set_ylim(0, 104)
        axes.set_yticks([0, 50, 100], labels=["0", "50", "100 %"] if place.first else [""] * 3)
        axes.tick_params(axis="y", length=0, labelsize=SMALL_SIZE)
        axes.grid(axis="y", color=LINE, linewidth=0.5)
        for place_number, one in enumerate(names):
            rated = by_place.get((one, question))
            reached = rated.at_least if rated else {}
            axes.add_line(_curve(place_number, scores, [reached.get(s, math.nan) for s in scores]))
        return {}

    def signs(words: Sequence[str]) -> list[Line2D]:
        return [_curve(place_number, (), (), label=word) for place_number, word in enumerate(words)]

    return panel_pictures(
        PanelFigure(
            told={question: _reached(conditions, question) for question in questions},
            # Rows that nobody sees give the panels their height.
            rows=(RowName(name=""),) * 7,
            draw=draw,
            legend=tuple(wording.name(one) for one in names),
            signs=signs,
        ),
        name=name,
        title="How many ratings reach each score",
        caption=f"{of_set(conditions[0].set)}"
        "How many of a condition's ratings are a score or a higher one, in %, "
        "after exclusions (cumulative lower bound). A line that stays above another "
        "belongs to better ratings; the figure is no test.",
        data=data,
        mark=mark,
    )


def _curve(
    place_number: int, scores: Sequence[float], percents: Sequence[float], label: str = ""
) -> Line2D:
    """Return the line of one condition: a colour, a style and a mark of its own."""
    return Line2D(
        list(scores),
        list(percents),
        color=SERIES[place_number % len(SERIES)],
        linestyle=_LINES[place_number // 3 % len(_LINES)],
        marker=_MARKERS[place_number % len(_MARKERS)],
        markersize=4,
        linewidth=1.3,
        label=label,
    )


def contrast_pictures(
    contrasts: Sequence[RatingContrast], *, name: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how much better each condition is rated than each other one, in scores."""
    pairs = list(dict.fromkeys((c.a, c.b) for c in contrasts))
    by_place = {(c.a, c.b, c.question): c for c in contrasts}
    questions = tuple(dict.fromkeys(c.question for c in contrasts))
    panels = {
        question: [_difference(by_place.get((a, b, question))) for a, b in pairs]
        for question in questions
    }
    limits = spread([dot for dots in panels.values() for dot in dots], around=0.0)
    return dot_pictures(
        panels,
        [RowName(name=f"{wording.name(a)} against {wording.name(b)}") for a, b in pairs],
        Scale(limits=limits, ticks=round_ticks(limits), label="difference in scores", line=0.0),
        name=name,
        title="Differences of paired ratings",
        told={
            question: f"{wording.heading(question)}. "
            + "; ".join(
                f"{wording.name(a)} against {wording.name(b)}: {dot.hint}"
                for (a, b), dot in zip(pairs, panels[question], strict=True)
            )
            + "."
            for question in questions
        },
        caption=f"{of_set(contrasts[0].set)}"
        "How much better the first condition is rated than the second, in scores: mean "
        f"difference of paired ratings with its {LEVEL:.0%} interval, clustered by participant "
        "and segment, after exclusions; p by Holm over the report.",
        data=data,
        mark=mark,
    )


def _difference(contrast: RatingContrast | None) -> Dot:
    if contrast is None or math.isnan(contrast.difference.estimate):
        return Dot(estimate=math.nan, words="–", hint="not known")
    found = contrast.difference
    inside = "" if math.isnan(found.low) else f" {between(number(found.low), number(found.high))}"
    p = wording.p_value(found.p_holm)
    return Dot(
        estimate=found.estimate,
        low=found.low,
        high=found.high,
        words=number(found.estimate),
        below="no test" if p == "–" else wording.p_is(found.p_holm),
        hint=f"{number(found.estimate)}{inside}, p (Holm) {p}",
    )


def _few(scores: Sequence[int]) -> tuple[int, ...]:
    return tuple(scores[:: max(1, len(scores) // 10)])


def _questions(conditions: Sequence[RatedCondition]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(c.question for c in conditions))


def _names(conditions: Sequence[RatedCondition]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(c.condition for c in conditions))


def _ratings(conditions: Sequence[RatedCondition], name: str) -> int:
    return max(c.n for c in conditions if c.condition == name)


def _bar(rated: RatedCondition | None) -> Bar:
    if rated is None or not rated.n:
        return Bar(start=0, parts=())
    condition = wording.name(rated.condition)
    return Bar(
        start=0,
        parts=tuple(
            Part(
                percent=100 * count / rated.n,
                hint=f"{condition}, score {score}: {count} of {rated.n} ratings "
                f"({100 * count / rated.n:.0f} %)",
            )
            for score, count in rated.counts.items()
        ),
        estimate=rated.estimate,
        low=rated.low,
        high=rated.high,
        words=number(rated.estimate),
        below="no interval" if rated.reason else between(number(rated.low), number(rated.high)),
    )


def _legend(scores: Sequence[int], labels: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    own = labels[0]
    if len(own) == len(scores) and all(other == own for other in labels):
        return tuple(f"{score} {label}" for score, label in zip(scores, own, strict=True))
    words = [str(score) for score in scores]
    words[0], words[-1] = f"{words[0]} (worst)", f"{words[-1]} (best)"
    return tuple(words)


def _scales(
    scores: Sequence[int], labels: Mapping[str, Sequence[str]], questions: Sequence[str]
) -> str:
    """Return what each question calls its scores, where the legend cannot say it for all."""
    called = {question: tuple(labels.get(question, ())) for question in questions}
    if len(set(called.values())) == 1:
        return ""
    return "".join(
        f" {wording.heading(question)}: "
        + ", ".join(f"{score} {label}" for score, label in zip(scores, words, strict=True))
        + "."
        for question, words in called.items()
        if len(words) == len(scores)
    )


def _given(conditions: Sequence[RatedCondition], question: str) -> str:
    parts = [
        f"{wording.name(c.condition)}: "
        + ", ".join(
            f"{100 * count / c.n:.0f} % score {score}" for score, count in c.counts.items() if c.n
        )
        + f", mean {number(c.estimate)}"
        for c in conditions
        if c.question == question
    ]
    return f"{wording.heading(question)}. {'; '.join(parts)}."


def _reached(conditions: Sequence[RatedCondition], question: str) -> str:
    parts = [
        f"{wording.name(c.condition)}: "
        + ", ".join(f"{percent:.0f} % at least {score}" for score, percent in c.at_least.items())
        for c in conditions
        if c.question == question
    ]
    return f"{wording.heading(question)}. {'; '.join(parts)}."
