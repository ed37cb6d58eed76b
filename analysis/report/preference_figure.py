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
from analysis.report.svg import STYLE, inline_svg

COLOURS: Final = ("#0072b2", "#56b4e9", "#d9dce0", "#e69f00", "#d55e00")
"""Okabe & Ito's blue and vermillion pairs, grey between, in the order of the five levels."""

_INK_ON: Final = ("white", "#16191d", "#16191d", "#16191d", "white")
_NARROWEST_LABEL: Final = 7.0
_COLUMNS: Final = 2


def preference_figure(
    preferences: Sequence[Preference], questions: Sequence[str], *, mark: str
) -> Markup:
    """Draw one panel per question and one bar per comparison.

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
    bars = 0.52 * len(others)
    hints: dict[str, str] = {}
    with mpl.rc_context(STYLE):
        height = lines * (bars + 0.95) + 0.75
        figure = Figure(figsize=(11.6, height))
        grid = figure.subplots(
            lines, _COLUMNS, squeeze=False, gridspec_kw={"wspace": 0.62, "hspace": 0.95 / bars}
        )
        figure.subplots_adjust(left=0.105, right=0.895, top=1 - 0.42 / height, bottom=1.02 / height)
        panels = grid.ravel().tolist()
        for number, (question, axes) in enumerate(zip(questions, panels, strict=False)):
            for row, other in enumerate(others):
                preference = by_place[other, question]
                gid = f"bar{number}-{row}"
                hints |= _bar(axes, row, preference, gid)
            _dress(axes, others, by_place, question, reference)
        for axes in panels[len(questions) :]:
            axes.set_visible(False)
        _legend(figure, reference, height)
        if mark:
            figure.text(
                0.995,
                1 - 0.02 / height,
                mark,
                ha="right",
                va="top",
                color="#a33f00",
                fontsize=9,
                fontweight="bold",
            )
        return inline_svg(figure, name="preferences", alt=_alt(preferences, reference), hints=hints)


def _sorted_others(preferences: Sequence[Preference], question: str) -> list[str]:
    shares = {p.other: p.win_share.estimate for p in preferences if p.question == question}
    return sorted(shares, key=lambda other: (math.isnan(shares[other]), -shares[other]))


def _bar(axes: Axes, row: int, preference: Preference, gid: str) -> dict[str, str]:
    """Draw one row; return the hover text of its parts."""
    percentages = preference.counts.percentages
    hints: dict[str, str] = {}
    if preference.counts.total:
        left = -(percentages[0] + percentages[1] + percentages[2] / 2)
        for level, width in enumerate(percentages):
            patch = axes.barh(row, width, left=left, height=0.62, color=COLOURS[level])[0]
            patch.set_gid(f"{gid}-{level}")
            hints[f"{gid}-{level}"] = _hint(preference, level)
            if width >= _NARROWEST_LABEL:
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
    mean = preference.win_share
    axes.text(
        1.03,
        row - 0.17,
        wording.share(mean.estimate),
        transform=axes.get_yaxis_transform(),
        va="center",
        fontsize=11,
        fontweight="bold",
    )
    axes.text(
        1.03,
        row + 0.24,
        textwrap.shorten(wording.interval(mean), 30),
        transform=axes.get_yaxis_transform(),
        va="center",
        fontsize=8.5,
    )
    return hints


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


def _dress(
    axes: Axes,
    others: Sequence[str],
    by_place: dict[tuple[str, str], Preference],
    question: str,
    reference: str,
) -> None:
    axes.set_title(
        wording.name(question).capitalize(), loc="left", fontsize=11.5, fontweight="bold", pad=12
    )
    axes.axvline(0, color="#22262b", linewidth=0.8, zorder=3)
    axes.set_xlim(-100, 100)
    axes.set_xticks([-100, -50, 0, 50, 100], labels=["100", "50", "0", "50", "100"])
    axes.set_ylim(len(others) - 0.5, -0.5)
    labels = []
    for other in others:
        raters = by_place[other, question].win_share.participants
        wrapped = "\n".join(textwrap.wrap(wording.name(other), 16)[:2])
        labels.append(f"{wrapped}\nn = {raters}")
    axes.set_yticks(range(len(others)), labels=labels, fontsize=9.5, linespacing=1.25)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=8.5)
    axes.set_xlabel(
        f"← share preferring {textwrap.shorten(reference, 20)}, %   ·   "
        "share preferring the other, % →",
        fontsize=8.5,
    )
    axes.text(
        1.03, 1.0, "win share", transform=axes.transAxes, fontsize=8.5, va="bottom", color="#5f6670"
    )


def _legend(figure: Figure, reference: str, height: float) -> None:
    handles = [
        Patch(color=colour, label=label)
        for colour, label in zip(COLOURS, _levels(reference, "the other"), strict=True)
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
