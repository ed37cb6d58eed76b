"""Preferences as bars around 'no difference' with win shares beside them: AMUSE's Figure 6."""

from __future__ import annotations

import math

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.bar_figure import Bar, BarFigure, Part, bar_pictures
from analysis.report.figures.ink import FIVE
from analysis.report.figures.panels import RowName, Scale
from analysis.report.headline.preference_rows import PreferenceGroup, PreferenceRow
from analysis.report.headline.words import interval, of_set, share_words
from analysis.stats.clustered_mean import LEVEL

SHARES = Scale(limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share", line=0.5)


def preference_pictures(
    group: PreferenceGroup, *, name: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw one panel per question and one bar per row."""
    labels = group.labels
    by_place = {(row.label, row.question): row for row in group.rows}
    rows = [[by_place.get((label, wording.name(q))) for label in labels] for q in group.questions]
    reach = _reach(group)
    figure = BarFigure(
        panels={
            question: tuple(map(_bar, found))
            for question, found in zip(group.questions, rows, strict=True)
        },
        told={question: _told(group, question) for question in group.questions},
        rows=tuple(RowName(name=label, below=f"n = {_people(group, label)}") for label in labels),
        colours=FIVE,
        legend=levels(group.one, group.other),
        bars=Scale(
            limits=(-reach, reach),
            ticks={-50: "50 %", 0: "0", 50: "50 %"},
            ends=(group.one.removeprefix("the "), group.other.removeprefix("the ")),
            line=0,
        ),
        estimates=SHARES,
    )
    return bar_pictures(
        figure,
        name=name,
        title=f"Answers for {group.one} and for {group.other}",
        caption=_caption(group),
        data=data,
        mark=mark,
    )


def levels(one: str, other: str) -> tuple[str, ...]:
    """Return what the five answers are called."""
    return (
        f"clearly {one}",
        f"slightly {one}",
        "no difference",
        f"slightly {other}",
        f"clearly {other}",
    )


def _bar(row: PreferenceRow | None) -> Bar:
    if row is None or not row.n:
        return Bar(start=0, parts=())
    percentages = row.percentages
    share = row.win_share
    return Bar(
        start=-(percentages[0] + percentages[1] + percentages[2] / 2),
        parts=tuple(
            Part(percent=percent, hint=f"{level}: {count} of {row.n} answers ({percent:.0f} %)")
            for percent, count, level in zip(
                percentages, row.levels, levels(row.one, row.other), strict=True
            )
        ),
        estimate=share.estimate,
        low=share.low,
        high=share.high,
        words=wording.share(share.estimate),
        below=interval(share) or "no interval",
    )


def _reach(group: PreferenceGroup) -> int:
    """Return how far the axis must go on both sides, in percent."""
    sides = [0.0]
    for row in group.rows:
        one_strong, one_weak, equal, other_weak, other_strong = row.percentages
        sides += [one_strong + one_weak + equal / 2, other_weak + other_strong + equal / 2]
    return min(100, max(60, math.ceil(max(sides)) + 5))


def _people(group: PreferenceGroup, label: str) -> int:
    return max(row.attentive for row in group.rows if row.label == label)


def _caption(group: PreferenceGroup) -> str:
    return (
        f"{of_set(group.set)}"
        f"Answers in %, around “no difference”: {group.one} to the left, {group.other} to the "
        "right; after exclusions; n: participants analysed. Right: win share of "
        f"{group.one} (preferences plus half of “no difference”) with its {LEVEL:.0%} interval, "
        "clustered by participant and segment; .5 means that neither is preferred."
    )


def _told(group: PreferenceGroup, question: str) -> str:
    parts = []
    for row in group.rows:
        if row.question != wording.name(question):
            continue
        if not row.n:
            parts.append(f"{row.label}: no answers")
            continue
        answers = ", ".join(
            f"{percent:.0f} % {level}"
            for percent, level in zip(row.percentages, levels(row.one, row.other), strict=True)
        )
        parts.append(f"{row.label}: {answers}; win share {share_words(row.win_share)}")
    return f"{wording.heading(question)}. {'. '.join(parts)}."
