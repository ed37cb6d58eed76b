"""Ratings as the user study of Speech2UnifiedExpressions shows them, and every contrast."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import Picture, Section, headline_section
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.panels import Hints, Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import LINE, SMALL_SIZE, Scale, scale_colours, sign_of
from analysis.report.figures.svg import About
from analysis.report.sections.rating_tables import (
    DATA,
    contrast_table,
    interval_table,
    model_table,
    score_table,
)
from analysis.report.subject import Subject
from analysis.report.wording import between, number, suffix, why_no_figure
from analysis.results.rating import RatedCondition, RatingResults
from analysis.results.rating_contrasts import RatingContrast
from analysis.stats.clustered_mean import LEVEL

MOST_PAIRS: Final = 15
"""Pairs of conditions up to which their differences are drawn."""


def rating_sections(results: RatingResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set.

    Parameters
    ----------
    results : RatingResults
        What was found.
    subject : Subject
        Names the points of the scales.
    """
    sets = dict.fromkeys(c.set for c in results.conditions)
    return tuple(
        _section(results, name, subject, suffix(name, place)) for place, name in enumerate(sets, 1)
    )


def _section(results: RatingResults, name: str | None, subject: Subject, end: str) -> Section:
    conditions = [c for c in results.conditions if c.set == name]
    contrasts = [c for c in results.contrasts if c.set == name]
    tables = [
        score_table(conditions),
        interval_table(conditions),
    ]
    if contrasts:
        tables += [
            contrast_table(contrasts),
            model_table(contrasts, results.clmm.of_set(name)),
        ]

    def pictures() -> tuple[Picture, ...]:
        labels, mark = subject.scale_labels, subject.mark
        few = 0 < len(contrasts) <= MOST_PAIRS * len({c.question for c in contrasts})
        return (
            *distribution_pictures(conditions, labels, name=f"ratings{end}", mark=mark),
            *cumulative_pictures(conditions, name=f"cumulative{end}", mark=mark),
            *(contrast_pictures(contrasts, name=f"contrasts{end}", mark=mark) if few else ()),
        )

    return headline_section(
        name,
        end,
        "How the conditions were rated",
        reason=why_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.participants for c in conditions),
            tied=_all_alike(conditions),
        ),
        pictures=pictures,
        tables=tables,
    )


def _all_alike(conditions: Sequence[RatedCondition]) -> str:
    given = {score for c in conditions for score, count in c.counts.items() if count}
    if len(given) != 1:
        return ""
    return (
        f"Every rating is {given.pop()}: nothing tells the conditions apart, so there is nothing "
        "to draw and nothing to test."
    )


def distribution_pictures(
    conditions: Sequence[RatedCondition],
    labels: Mapping[str, Sequence[str]],
    *,
    name: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw how often each score was given, with means beside: S2UE's Figure 6.

    Parameters
    ----------
    conditions : sequence of RatedCondition
        Of one set.
    labels : mapping of str to sequence of str
        By question, what its scores are called, worst first; the legend says so where all
        questions agree.
    name, mark
        See `analysis.report.figures.svg.About`.
    """
    scores = tuple(conditions[0].counts)
    questions = tuple(dict.fromkeys(c.question for c in conditions))
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    by_place = {(c.condition, c.question): c for c in conditions}
    ratings = {one: max(c.n for c in conditions if c.condition == one) for one in names}
    words = _legend(scores, [tuple(labels.get(question, ())) for question in questions])
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
        About(
            name=name,
            title="How often each score was given",
            caption="How often each score was given, in % of a condition's n ratings, worst on the "
            "left; after exclusions. Right: mean with its "
            f"{LEVEL:.0%} interval, clustered by participant and segment."
            f"{_scales(scores, labels, questions)}",
            data=DATA,
            mark=mark,
        ),
    )


def cumulative_pictures(
    conditions: Sequence[RatedCondition], *, name: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how many ratings reach each score, a line per condition: S2UE's Figure 7."""
    scores = tuple(conditions[0].counts)
    by_place = {(c.condition, c.question): c for c in conditions}
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    shown = scores[:: max(1, len(scores) // 10)]
    scale = Scale(
        limits=(scores[0] - 0.1, scores[-1] + 0.1),
        ticks={score: str(score) for score in shown},
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
        + "; ".join(f"{wording.condition(c.condition)}: {_reached(c)}" for c in of_question)
        + "."
        for question in dict.fromkeys(c.question for c in conditions)
        if (of_question := [c for c in conditions if c.question == question])
    }
    return panel_pictures(
        PanelFigure(
            told=told,
            draw=draw,
            height=1.9,
            legend=[_curve(place, {}, wording.condition(one)) for place, one in enumerate(names)],
        ),
        About(
            name=name,
            title="How many ratings reach each score",
            caption="How many of a condition's ratings are a score or a higher one, in %, after "
            "exclusions (cumulative lower bound). A line that stays above another belongs to "
            "better ratings; the figure is not a test.",
            data=DATA,
            mark=mark,
        ),
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


def contrast_pictures(
    contrasts: Sequence[RatingContrast], *, name: str, mark: str
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
        About(
            name=name,
            title="Differences of paired ratings",
            caption="How much better the first condition is rated than the second, in scores: mean "
            f"difference of paired ratings with its {LEVEL:.0%} interval, clustered by participant "
            "and segment, after exclusions; p by Holm over the report.",
            data="contrasts.csv",
            mark=mark,
        ),
    )


def _difference(contrast: RatingContrast | None) -> Dot:
    if contrast is None or math.isnan(contrast.difference.estimate):
        return Dot(words="–", hint="not known")
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


def _bar(rated: RatedCondition | None) -> Bar:
    if rated is None or not rated.n:
        return Bar()
    return Bar(
        parts=tuple(
            Part(
                percent=100 * count / rated.n,
                colour=colour,
                hint=f"score {score}: {count} of {rated.n} ratings ({100 * count / rated.n:.0f}%)",
            )
            for (score, count), colour in zip(
                rated.counts.items(), scale_colours(len(rated.counts)), strict=True
            )
        ),
        beside=rated,
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
