"""Strengths or worths of conditions with their errors and the ranks that they allow."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.headline.dot_figure import Dot, dot_pictures, round_ticks, spread
from analysis.report.headline.panels import RowName, Scale
from analysis.report.headline.words import between, number


@dataclass(frozen=True, kw_only=True)
class Standing:
    """Where one condition stands.

    Attributes
    ----------
    condition : str
        Its name.
    value, low, high : float
        On a log scale on which all conditions add up to zero, with its interval.
    ranks : str
        Those it may have, '1–2'.
    """

    condition: str
    value: float
    low: float
    high: float
    ranks: str


def strength_pictures(
    standings: Mapping[str, Sequence[Standing]],
    *,
    axis: str,
    name: str,
    title: str,
    caption: str,
    data: str,
    mark: str,
) -> tuple[Picture, ...]:
    """Draw a panel per question and a row per condition, the strongest on the first one on top.

    Parameters
    ----------
    standings : mapping of str to sequence of Standing
        By question.
    axis : str
        What the values are.
    name, title, caption, data
        See `analysis.report.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    first = next(iter(standings.values()))
    values = {one.condition: one.value for one in first if not math.isnan(one.value)}
    names = dict.fromkeys(one.condition for found in standings.values() for one in found)
    order = sorted(names, key=lambda one: -values.get(one, -math.inf))
    panels = {question: _dots(order, found) for question, found in standings.items()}
    limits = spread([dot for dots in panels.values() for dot in dots], around=0.0)
    return dot_pictures(
        panels,
        [RowName(name=wording.name(one)) for one in order],
        Scale(limits=limits, ticks=round_ticks(limits), label=axis, line=0.0),
        name=name,
        title=title,
        told={question: _told(question, found) for question, found in standings.items()},
        caption=caption,
        data=data,
        mark=mark,
    )


def _dots(order: Sequence[str], standings: Sequence[Standing]) -> list[Dot]:
    by_name = {one.condition: one for one in standings}
    return [_dot(by_name.get(name)) for name in order]


def _dot(one: Standing | None) -> Dot:
    if one is None or math.isnan(one.value):
        return Dot(estimate=math.nan, words="–")
    return Dot(
        estimate=one.value,
        low=one.low,
        high=one.high,
        words=number(one.value),
        below=f"rank {one.ranks}" if one.ranks != "–" else "",
        hint=f"{wording.name(one.condition)}: {_words(one)}",
    )


def _words(one: Standing) -> str:
    if math.isnan(one.value):
        return "not known"
    inside = "" if math.isnan(one.low) else f" {between(number(one.low), number(one.high))}"
    return f"{number(one.value)}{inside}, rank {one.ranks}"


def _told(question: str, standings: Sequence[Standing]) -> str:
    parts = [f"{wording.name(one.condition)}: {_words(one)}" for one in standings]
    return f"{wording.heading(question)}. {'; '.join(parts)}."
