"""Rankings as DiffSHEG's Figure 7 shows them, and how sure one can be of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.bar_figure import Bar, BarFigure, Part, bar_pictures
from analysis.report.figures.dot_figure import Dot, dot_pictures
from analysis.report.figures.ink import place_colours
from analysis.report.figures.panels import RowName, Scale
from analysis.report.headline.words import between, interval, number, of_set, share_words
from analysis.results.ranking import RankedCondition
from analysis.stats.clustered_mean import LEVEL


def place_pictures(
    conditions: Sequence[RankedCondition], *, name: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came to each place, mean ranks beside: a panel per question.

    Parameters
    ----------
    conditions : sequence of RankedCondition
        Of one set.
    name, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    places = max(len(one.rank_percent) for one in conditions)
    names = best_first(conditions)
    figure = BarFigure(
        panels={
            question: tuple(_bar(found.get(one)) for one in names)
            for question, found in _by_question(conditions).items()
        },
        told={
            question: _told(question, found, _placed)
            for question, found in _by_question(conditions).items()
        },
        rows=_rows(names, conditions),
        colours=place_colours(places),
        legend=tuple(ordinal(place) for place in range(1, places + 1)),
        bars=Scale(limits=(0, 100), ticks={0: "0", 50: "50", 100: "100"}, label="% of rankings"),
        estimates=Scale(limits=(1, places), ticks={1: "1", places: str(places)}, label="mean rank"),
    )
    return bar_pictures(
        figure,
        name=name,
        title="How often each condition came to each place",
        caption=f"{of_set(conditions[0].set)}"
        "How often each condition came to each place, in % of its n rankings, the first "
        "place on the left; tied conditions share their places; after exclusions. Right: mean "
        f"rank (1 is best) with its {LEVEL:.0%} interval, clustered by participant and segment "
        ".",
        data=data,
        mark=mark,
    )


def first_share_pictures(
    conditions: Sequence[RankedCondition], *, name: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw how often each condition came first, with intervals and with what chance gives."""
    names = best_first(conditions)
    chance = 1 / len(names)
    panels = {
        question: [_first(found.get(one)) for one in names]
        for question, found in _by_question(conditions).items()
    }
    return dot_pictures(
        panels,
        _rows(names, conditions),
        Scale(
            limits=(0, 1),
            ticks={0: "0", 0.25: ".25", 0.5: ".5", 0.75: ".75", 1: "1"},
            label="share of first places",
            line=chance,
        ),
        name=name,
        title="Share of first places",
        told={
            question: _told(question, found, lambda c: share_words(c.first_share))
            for question, found in _by_question(conditions).items()
        },
        caption=f"{of_set(conditions[0].set)}"
        f"Share of rankings in which each condition came first, with its {LEVEL:.0%} "
        "interval, clustered by participant and segment; conditions tied for the first "
        f"place share it. The line is what chance gives, {wording.share(chance)}.",
        data=data,
        mark=mark,
    )


def best_first(conditions: Sequence[RankedCondition]) -> tuple[str, ...]:
    """Return the conditions by their mean rank on the first question."""
    first = conditions[0].question
    ranks = {c.condition: c.mean_rank.estimate for c in conditions if c.question == first}
    names = dict.fromkeys(c.condition for c in conditions)
    return tuple(sorted(names, key=lambda one: ranks.get(one, float("inf"))))


def ordinal(place: int) -> str:
    """Return a place as '1st', '2nd', '3rd', '4th'."""
    ending = "th" if 10 < place % 100 < 14 else {1: "st", 2: "nd", 3: "rd"}.get(place % 10, "th")
    return f"{place}{ending}"


def _by_question(
    conditions: Sequence[RankedCondition],
) -> Mapping[str, Mapping[str, RankedCondition]]:
    found: dict[str, dict[str, RankedCondition]] = {}
    for one in conditions:
        found.setdefault(one.question, {})[one.condition] = one
    return found


def _rows(names: Sequence[str], conditions: Sequence[RankedCondition]) -> tuple[RowName, ...]:
    return tuple(
        RowName(
            name=wording.name(name),
            below=f"n = {max(c.n for c in conditions if c.condition == name)}",
        )
        for name in names
    )


def _bar(ranked: RankedCondition | None) -> Bar:
    if ranked is None or not ranked.n:
        return Bar(start=0, parts=())
    mean = ranked.mean_rank
    return Bar(
        start=0,
        parts=tuple(
            Part(
                percent=percent,
                hint=f"{wording.name(ranked.condition)}: {ordinal(place)} in {percent:.0f} % of "
                f"{ranked.n} rankings",
            )
            for place, percent in ranked.rank_percent.items()
        ),
        estimate=ranked.mean_rank.estimate,
        low=mean.low,
        high=mean.high,
        words=number(ranked.mean_rank.estimate),
        below="no interval" if mean.reason else between(number(mean.low), number(mean.high)),
    )


def _first(ranked: RankedCondition | None) -> Dot:
    if ranked is None or not ranked.n:
        return Dot(estimate=float("nan"), words="no answers")
    share = ranked.first_share
    return Dot(
        estimate=ranked.first_share.estimate,
        low=share.low,
        high=share.high,
        words=wording.share(ranked.first_share.estimate),
        below=interval(share) or "no interval",
        hint=f"{wording.name(ranked.condition)}: {share_words(share)}",
    )


def _told(
    question: str, found: Mapping[str, RankedCondition], words: Callable[[RankedCondition], str]
) -> str:
    parts = [f"{wording.name(name)}: {words(one)}" for name, one in found.items()]
    return f"{wording.heading(question)}. {'; '.join(parts)}."


def _placed(one: RankedCondition) -> str:
    places = [f"{percent:.0f} % {ordinal(place)}" for place, percent in one.rank_percent.items()]
    return f"{', '.join(places)}, mean rank {number(one.mean_rank.estimate)}"
