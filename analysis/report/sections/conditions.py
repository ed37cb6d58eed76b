"""Conditions that are rated or ranked, as S2UE and DiffSHEG show them, and strengths."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Final

from matplotlib.lines import Line2D

from analysis.report import wording
from analysis.report.content import FigureText, Picture, Section, Subject, Table, headline_section
from analysis.report.figures.estimates import (
    Bar,
    Dot,
    Part,
    bar_of,
    bar_pictures,
    condition_bars,
    dot_of,
    dot_pictures,
)
from analysis.report.figures.panels import Panel, PanelFigure, Row, panel_pictures
from analysis.report.figures.style import (
    LINE,
    SMALL_SIZE,
    Scale,
    place_colours,
    scale_colours,
    series_style,
)
from analysis.report.sections.metric_table import first_and_second
from analysis.report.texts import figure_text, table
from analysis.report.wording import ordinal, ranks, reason_for_no_figure, set_suffix
from analysis.results.conditions import (
    RankedCondition,
    RankingResults,
    RatedCondition,
    RatingContrast,
    RatingResults,
)
from analysis.results.strengths import ConditionStrength, StrengthModel
from analysis.stats.strength_models import ALL_TIED

MOST_PAIRS: Final = 15
"""Most pairs of conditions whose differences are drawn."""

_PERCENT_TICKS: Final[Mapping[float, str]] = {0: "0", 50: "50", 100: "100"}


def condition_sections(
    results: RatingResults | RankingResults, subject: Subject
) -> Iterator[Section]:
    """Yield one section for each set."""
    sets = dict.fromkeys(c.set for c in results.conditions)
    for number, name in enumerate(sets, start=1):
        suffix = set_suffix(name, number)
        if isinstance(results, RatingResults):
            yield _rating_section(results, name, subject, suffix)
        else:
            yield _ranking_section(results, name, suffix)


def _rating_section(
    results: RatingResults, set_name: str | None, subject: Subject, suffix: str
) -> Section:
    conditions = [c for c in results.conditions if c.set == set_name]
    contrasts = [c for c in results.contrasts if c.set == set_name]
    tables = [_scores(conditions), table("means", conditions)]
    if contrasts:
        tables.append(table("rating-contrasts", contrasts))
        tables.append(table("model", contrasts, models=results.clmm.of_set(set_name)))

    def pictures() -> tuple[Picture, ...]:
        draws_contrasts = 0 < len(contrasts) <= MOST_PAIRS * len({c.question for c in contrasts})
        return (
            *distribution_pictures(conditions, subject.scale_labels, suffix=suffix),
            *_cumulative_pictures(conditions, suffix),
            *(_contrast_pictures(contrasts, suffix) if draws_contrasts else ()),
        )

    scores = {score for c in conditions for score, count in c.counts.items() if count}
    return headline_section(
        set_name,
        suffix,
        "How the conditions were rated",
        no_figure=reason_for_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.participants for c in conditions),
            tied=f"Every rating is {scores.pop()}: nothing tells the conditions apart"
            if len(scores) == 1
            else "",
        ),
        pictures=pictures,
        tables=tables,
    )


def _scores(conditions: Sequence[RatedCondition]) -> Table:
    """Return the table of means, with the best and the second best (as printed) marked."""
    best, second = [], []
    for question in dict.fromkeys(c.question for c in conditions):
        asked = [c for c in conditions if c.question == question]
        places = first_and_second([c.estimate for c in asked], "higher", math.nan, 2)
        best += [asked[place] for place in places[0]]
        second += [asked[place] for place in places[1]]
    return table("scores", conditions, best=best, second=second)


def distribution_pictures(
    conditions: Sequence[RatedCondition],
    labels: Mapping[str, Sequence[str]],
    *,
    suffix: str = "",
) -> tuple[Picture, ...]:
    """Draw how often each score was given, with means: S2UE's Figure 6.

    `labels` name each question's scores, worst first. They are in the legend if all questions share
    them, otherwise in the caption.
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
    panels, rows = condition_bars(
        conditions, dict.fromkeys(c.condition for c in conditions), _rating_bar
    )
    return bar_pictures(
        panels,
        rows,
        dict(zip(legend, scale_colours(len(scores)), strict=True)),
        Scale(limits=(0, 100), ticks=_PERCENT_TICKS, label="% of ratings"),
        Scale(limits=ends, ticks={score: str(score) for score in ends}, label="mean"),
        figure_text("ratings", suffix=suffix, labels_by_question=in_caption, scores=scores),
    )


def _rating_bar(rated: RatedCondition) -> Bar:
    parts = []
    for score, count in rated.counts.items():
        percent = 100 * count / rated.n
        parts.append(Part(percent, f"score {score}: {count} of {rated.n} ratings ({percent:.0f}%)"))
    return bar_of(parts, rated)


def _cumulative_pictures(conditions: Sequence[RatedCondition], suffix: str) -> tuple[Picture, ...]:
    """Draw how many ratings reach each score, a line per condition: S2UE's Figure 7."""
    scores = tuple(conditions[0].counts)
    by_name = {(c.condition, c.question): c for c in conditions}
    names = tuple(dict.fromkeys(c.condition for c in conditions))
    questions = tuple(dict.fromkeys(c.question for c in conditions))
    scale = Scale(
        limits=(scores[0] - 0.1, scores[-1] + 0.1),
        ticks={score: str(score) for score in scores[:: max(1, len(scores) // 10)]},
        label="score or higher",
    )

    def draw(panel: Panel, question: str) -> Iterator[str]:
        [axes] = panel.axes
        for index, name in enumerate(names):
            if rated := by_name.get((name, question)):
                axes.add_line(_curve(index, rated.at_least))
                shares = (
                    f"{share:.0f}% at least {score}" for score, share in rated.at_least.items()
                )
                yield f"{wording.condition(name)}: {', '.join(shares)}"
        scale.apply(axes, panel.inches)
        axes.set_ylim(0, 104)
        axes.set_yticks([0, 50, 100], labels=["0", "50", "100%"] if panel.is_first else [""] * 3)
        axes.tick_params(axis="y", length=0, labelsize=SMALL_SIZE)
        axes.grid(axis="y", color=LINE, linewidth=0.5)

    legend = [_curve(index, {}, wording.condition(name)) for index, name in enumerate(names)]
    return panel_pictures(
        PanelFigure(titles=questions, draw=draw, height=1.9, legend=legend),
        figure_text("cumulative", suffix=suffix),
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


def _contrast_pictures(contrasts: Sequence[RatingContrast], suffix: str) -> tuple[Picture, ...]:
    """Draw how much better the first condition of each pair is rated, in scores."""
    pairs = list(dict.fromkeys((c.a, c.b) for c in contrasts))
    by_pair = {(c.a, c.b, c.question): c for c in contrasts}
    return dot_pictures(
        {
            question: [_contrast_dot(by_pair.get((a, b, question))) for a, b in pairs]
            for question in dict.fromkeys(c.question for c in contrasts)
        },
        [Row(wording.against(a, b)) for a, b in pairs],
        Scale(label="difference in scores", line=0.0),
        figure_text("contrasts", suffix=suffix),
    )


def _contrast_dot(contrast: RatingContrast | None) -> Dot:
    if contrast is None:
        return dot_of(None, wording.number)
    p = contrast.difference.p_holm
    below = "no test" if math.isnan(p) else wording.p_is(p)
    more = f", p (Holm) {wording.p_value(p)}"
    return dot_of(contrast.difference, wording.number, below=below, more=more)


def _ranking_section(results: RankingResults, set_name: str | None, suffix: str) -> Section:
    conditions = [c for c in results.conditions if c.set == set_name]
    contrasts = [c for c in results.contrasts if c.set == set_name]
    posthoc = [c for c in results.posthoc if c.set == set_name]
    worths = results.plackett_luce.of_set(set_name)
    places = max(len(c.rank_percent) for c in conditions)
    tables = [
        table("ranks", conditions, tested=results.friedman.of_set(set_name)),
        table("places", conditions, places=places),
        standings_table(worths, "worths"),
    ]
    if contrasts:
        tables.append(
            table("contrasts", contrasts, fitted=worths, estimates="worths", decisive=True)
        )
    if posthoc:
        tables.append(table("posthoc", posthoc))
    text = figure_text("worths", suffix=suffix)
    return headline_section(
        set_name,
        suffix,
        "How the conditions were ranked",
        no_figure=reason_for_no_figure(
            answers=sum(c.n for c in conditions),
            participants=max(c.mean_rank.participants for c in conditions),
            tied="Every ranking ties all conditions: nobody ranked one above another"
            if {fit.reason for fit in worths.values()} == {ALL_TIED}
            else "",
        ),
        pictures=lambda: (
            *_place_pictures(conditions, places, suffix),
            *strength_pictures(worths, "worth, log scale", text),
        ),
        tables=tables,
    )


def _place_pictures(
    conditions: Sequence[RankedCondition], places: int, suffix: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came to each place, with mean ranks: a panel per question."""
    on_first = [c for c in conditions if c.question == conditions[0].question]
    best_first = sorted(on_first, key=lambda c: c.mean_rank.estimate)
    names = dict.fromkeys(c.condition for c in (*best_first, *conditions))
    panels, rows = condition_bars(conditions, names, _ranking_bar)
    return bar_pictures(
        panels,
        rows,
        dict(zip(map(ordinal, range(1, places + 1)), place_colours(places), strict=True)),
        Scale(limits=(0, 100), ticks=_PERCENT_TICKS, label="% of rankings"),
        Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
        figure_text("places", suffix=suffix),
    )


def _ranking_bar(ranked: RankedCondition) -> Bar:
    return bar_of(
        [
            Part(percent, f"{ordinal(place)} in {percent:.0f}% of {ranked.n} rankings")
            for place, percent in ranked.rank_percent.items()
        ],
        ranked.mean_rank,
    )


def strength_pictures(
    standings: Mapping[str, StrengthModel], axis: str, text: FigureText
) -> tuple[Picture, ...]:
    """Draw the strengths on each question with a fit, the strongest on the first one on top."""
    fitted = {
        question: fit for question, fit in standings.items() if not fit.reason and fit.conditions
    }
    if not fitted:
        return ()
    by_name = {
        question: {c.condition: c for c in fit.conditions} for question, fit in fitted.items()
    }
    order = strongest_first(fitted, [name for fit in by_name.values() for name in fit])
    return dot_pictures(
        {
            question: [_strength_dot(fit.get(name)) for name in order]
            for question, fit in by_name.items()
        },
        [Row(wording.condition(name)) for name in order],
        Scale(label=axis, line=0.0),
        text,
    )


def strongest_first(standings: Mapping[str, StrengthModel], names: Iterable[str]) -> list[str]:
    """Return each name once, by strength on the first question with a fit."""
    conditions = next((fit.conditions for fit in standings.values() if not fit.reason), ())
    strengths = {c.condition: c.estimate for c in conditions if not math.isnan(c.estimate)}
    return sorted(dict.fromkeys(names), key=lambda name: -strengths.get(name, -math.inf))


def _strength_dot(standing: ConditionStrength | None) -> Dot:
    rank = ranks(standing)
    below = f"rank {rank}" if rank != "–" else ""
    return dot_of(standing, wording.number, below=below, more=f", rank {rank}")


def standings_table(standings: Mapping[str, StrengthModel], kind: str) -> Table:
    """Return 'strengths' or 'worths', errors and ranks by question, the strongest first."""
    rows = [
        (question, standing)
        for question, fit in standings.items()
        for standing in sorted(fit.conditions, key=lambda c: (math.isnan(c.estimate), -c.estimate))
    ]
    return table(kind, rows, fitted=standings)
