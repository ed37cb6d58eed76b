"""Ratings as the user study of Speech2UnifiedExpressions shows them, and every contrast."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Final

from analysis.report import wording
from analysis.report.by_question import of
from analysis.report.content import Picture, Section
from analysis.report.figures.bars import Bar, Part, bar_pictures
from analysis.report.figures.dots import Dot, dot_pictures
from analysis.report.figures.ink import scale_colours
from analysis.report.figures.panels import Row, Scale
from analysis.report.figures.svg import About
from analysis.report.headline.rating_tables import (
    contrast_table,
    interval_table,
    model_table,
    score_table,
)
from analysis.report.headline.words import between, in_set, number, of_set, suffix, why_no_figure
from analysis.report.subject import Subject
from analysis.results.rating import RatedCondition, RatingResults
from analysis.results.rating_contrasts import RatingContrast
from analysis.stats.clustered_mean import LEVEL

MOST_PAIRS: Final = 15
"""Pairs of conditions up to which their differences are drawn."""

_DATA: Final = "conditions.csv"


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
    reason = why_no_figure(
        answers=sum(c.n for c in conditions),
        participants=max(c.participants for c in conditions),
        tied=_all_alike(conditions),
    )
    tables = [
        score_table(conditions, name=f"scores{end}", data=_DATA),
        interval_table(conditions, name=f"means{end}", data=_DATA),
    ]
    if contrasts:
        tables += [
            contrast_table(contrasts, name=f"contrasts{end}"),
            model_table(contrasts, of(results.clmm, name), name=f"model{end}"),
        ]
    pictures: tuple[Picture, ...] = ()
    if not reason:
        pictures = distribution_pictures(
            conditions, subject.scale_labels, name=f"ratings{end}", mark=subject.mark
        )
        if 0 < len(contrasts) <= MOST_PAIRS * len({c.question for c in contrasts}):
            pictures += contrast_pictures(contrasts, name=f"contrasts{end}", mark=subject.mark)
    return Section(
        anchor=f"headline{end}",
        heading=in_set(name, "How the conditions were rated"),
        paragraphs=(reason,) if reason else (),
        pictures=pictures,
        tables=tuple(tables),
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
    """Draw how often each score was given, with means beside: S2UE's Figures 6 and 7 in one.

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
        [Row(wording.name(one), f"n = {ratings[one]}") for one in names],
        dict(zip(words, scale_colours(len(scores)), strict=True)),
        Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of ratings"),
        Scale(limits=ends, ticks={score: str(score) for score in ends}, label="mean"),
        About(
            name=name,
            title="How often each score was given",
            caption=f"{of_set(conditions[0].set)}"
            "How often each score was given, in % of a condition's n ratings, worst on the "
            "left; after exclusions. What begins at a score and goes on to the right are the "
            "ratings that reach it (cumulative lower bound). Right: mean with its "
            f"{LEVEL:.0%} interval, clustered by participant and segment."
            f"{_scales(scores, labels, questions)}",
            data=_DATA,
            mark=mark,
        ),
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
        [Row(f"{wording.name(a)} against {wording.name(b)}") for a, b in pairs],
        Scale(label="difference in scores", line=0.0),
        About(
            name=name,
            title="Differences of paired ratings",
            caption=f"{of_set(contrasts[0].set)}"
            "How much better the first condition is rated than the second, in scores: mean "
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
                hint=f"score {score}: {count} of {rated.n} ratings "
                f"({100 * count / rated.n:.0f} %; {rated.at_least[score]:.0f} % at least {score})",
            )
            for (score, count), colour in zip(
                rated.counts.items(), scale_colours(len(rated.counts)), strict=True
            )
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
