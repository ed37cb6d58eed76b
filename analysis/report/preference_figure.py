"""The first figure: answers as stacked bars around 'no difference', as AMUSE's Figure 6."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Final

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from analysis.preferences.counts import FiveLevelCounts
from analysis.preferences.win_share import Preference
from analysis.report import wording
from analysis.report.ink import STYLE
from analysis.report.svg import inline_svg

COLOURS: Final = ("#0072b2", "#56b4e9", "#d9dce0", "#e69f00", "#d55e00")
"""Okabe & Ito's blue and vermillion pairs, grey between, in the order of the five levels."""

_INK_ON: Final = ("white", "#16191d", "#16191d", "#16191d", "white")
_NARROWEST_LABEL: Final = 0.045
"""Share of the axis that a part must span to carry its number."""

_COLUMNS: Final = 2


def preference_figure(
    preferences: Sequence[Preference], questions: Sequence[str], *, mark: str
) -> Markup:
    """Draw one panel per question and one bar per comparison, its win share beside it.

    Parameters
    ----------
    preferences : sequence of Preference
        All with the same reference.
    questions : sequence of str
        Panels, from left to right.
    mark : str
        Written into a corner, so that a copied figure keeps it; empty for none.
    """
    others = _sorted_others(preferences, questions[0])
    by_place = {(p.other, p.question): p for p in preferences}
    reference = wording.name(preferences[0].reference)
    lines = math.ceil(len(questions) / _COLUMNS)
    height = lines * (0.5 * len(others) + 1.05) + 0.42
    reach = _reach(preferences)
    hints: dict[str, str] = {}
    with mpl.rc_context({**STYLE, "font.size": 10.0}):
        figure = Figure(figsize=(10.0, height))
        grid = figure.add_gridspec(
            lines,
            3 * _COLUMNS - 1,
            width_ratios=[3.6, 1.15, *([0.72, 3.6, 1.15] * (_COLUMNS - 1))],
            hspace=1.05 / (0.5 * len(others)),
            wspace=0.06,
            left=0.12,
            right=0.91,
            top=1 - 0.55 / height,
            bottom=0.92 / height,
        )
        for number, question in enumerate(questions):
            line, column = divmod(number, _COLUMNS)
            bars = figure.add_subplot(grid[line, 3 * column])
            forest = figure.add_subplot(grid[line, 3 * column + 1])
            found = [by_place[other, question] for other in others]
            for row, preference in enumerate(found):
                hints |= _bar(bars, row, preference, f"bar{number}-{row}", reach)
                _win_share(forest, row, preference)
            _dress_bars(bars, found, question, reach, labelled=column == 0)
            _dress_forest(forest, len(others))
        _legend(figure, reference, height)
        if mark:
            figure.text(
                0.12,
                1 - 0.03 / height,
                mark,
                va="top",
                color="#8a3500",
                fontsize=9,
                fontweight="bold",
            )
        return inline_svg(figure, name="preferences", alt=_alt(preferences, reference), hints=hints)


def _reach(preferences: Sequence[Preference]) -> int:
    """Return how far the axis must go on both sides, in percent."""
    sides = [0.0]
    for p in preferences:
        if p.counts.total:
            half = p.counts.indifferent / 2
            sides += [p.counts.ours + half, p.counts.others + half]
    return min(100, max(60, math.ceil(max(sides)) + 5))


def _sorted_others(preferences: Sequence[Preference], question: str) -> list[str]:
    shares = {p.other: p.win_share.estimate for p in preferences if p.question == question}
    return sorted(shares, key=lambda other: (math.isnan(shares[other]), -shares[other]))


def _bar(axes: Axes, row: int, preference: Preference, gid: str, reach: int) -> dict[str, str]:
    """Draw one row of bars; return the hover text of its parts."""
    hints: dict[str, str] = {}
    if not preference.counts.total:
        axes.text(0, row, "no answers", ha="center", va="center", fontsize=9)
        return hints
    percentages = preference.counts.percentages
    left = -(percentages[0] + percentages[1] + percentages[2] / 2)
    for level, width in enumerate(percentages):
        patch = axes.barh(row, width, left=left, height=0.62, color=COLOURS[level])[0]
        patch.set_gid(f"{gid}-{level}")
        hints[f"{gid}-{level}"] = _hint(preference, level)
        if width >= _NARROWEST_LABEL * 2 * reach:
            axes.text(
                left + width / 2,
                row,
                f"{width:.0f}",
                ha="center",
                va="center",
                color=_INK_ON[level],
                fontsize=9,
            )
        left += width
    return hints


def _win_share(axes: Axes, row: int, preference: Preference) -> None:
    mean = preference.win_share
    if not mean.answers:
        return
    if not mean.reason:
        axes.plot(
            [mean.low, mean.high], [row, row], color="#16191d", linewidth=1.6, solid_capstyle="butt"
        )
    axes.plot([mean.estimate], [row], marker="o", markersize=5.5, color="#16191d")
    beside = axes.get_yaxis_transform()
    axes.text(
        1.08,
        row - 0.16,
        wording.share(mean.estimate),
        transform=beside,
        va="center",
        fontsize=11,
        fontweight="bold",
    )
    axes.text(
        1.08,
        row + 0.23,
        mean.reason or wording.interval(mean),
        transform=beside,
        va="center",
        fontsize=8.5,
    )


def _hint(preference: Preference, level: int) -> str:
    counts: FiveLevelCounts = preference.counts
    return (
        f"{_levels(wording.name(preference.reference), wording.name(preference.other))[level]}: "
        f"{counts.levels[level]} of {counts.total} answers ({counts.percentages[level]:.0f} %)"
    )


def _levels(reference: str, other: str) -> tuple[str, ...]:
    return (
        f"clearly {reference}",
        f"slightly {reference}",
        "no difference",
        f"slightly {other}",
        f"clearly {other}",
    )


def _dress_bars(
    axes: Axes, found: Sequence[Preference], question: str, reach: int, *, labelled: bool
) -> None:
    reference = wording.clipped(wording.name(found[0].reference), 12)
    axes.set_title(wording.heading(question), loc="left", fontsize=11.5, fontweight="bold", pad=9)
    axes.axvline(0, color="#5f6670", linewidth=0.8, zorder=0)
    axes.set_xlim(-reach, reach)
    axes.set_xticks([-50, 0, 50], labels=["50", "0", "50"])
    axes.set_ylim(len(found) - 0.5, -0.5)
    labels = [
        "\n".join(
            [
                *textwrap.wrap(wording.name(p.other), 16, max_lines=2, placeholder=" …"),
                f"n = {p.win_share.participants}",
            ]
        )
        for p in found
    ]
    axes.set_yticks(range(len(found)), labels=labels if labelled else [""] * len(found))
    axes.tick_params(axis="y", length=0, labelsize=9.5)
    axes.tick_params(axis="x", labelsize=8.5)
    axes.set_xlabel(f"← prefer {reference} · % · prefer the other →", fontsize=9)


def _dress_forest(axes: Axes, rows: int) -> None:
    axes.axvline(0.5, color="#5f6670", linewidth=0.8, zorder=0)
    axes.set_xlim(0, 1)
    axes.set_xticks([0, 0.5, 1], labels=["0", ".5", "1"])
    axes.set_ylim(rows - 0.5, -0.5)
    axes.set_yticks([])
    axes.tick_params(axis="x", labelsize=8.5)
    axes.set_xlabel("win share", fontsize=9)


def _legend(figure: Figure, reference: str, height: float) -> None:
    handles = [
        Patch(color=colour, label=label)
        for colour, label in zip(
            COLOURS, _levels(wording.clipped(reference, 20), "the other"), strict=True
        )
    ]
    figure.legend(
        handles=handles,
        loc="lower center",
        ncols=5,
        frameon=False,
        fontsize=9,
        bbox_to_anchor=(0.5, 0.02 / height),
        handlelength=1.1,
        columnspacing=1.6,
    )


def _alt(preferences: Sequence[Preference], reference: str) -> str:
    parts = [
        f"{wording.name(p.question)}, {reference} against {wording.name(p.other)}: "
        f"win share {wording.estimate(p.win_share)}"
        for p in preferences
    ]
    return f"Stacked bars of the five answers around no difference. {'; '.join(parts)}."
