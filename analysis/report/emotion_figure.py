"""Win shares within each emotion as a forest plot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from analysis.preferences.segments import SegmentShare
from analysis.preferences.win_share import Preference
from analysis.report import wording
from analysis.report.ink import STYLE
from analysis.report.svg import inline_svg

FEW_SEGMENTS: Final = 6
"""With fewer segments than this, a clustered interval is a description, not a test."""

_INK: Final = "#0072b2"


def emotion_figure(
    emotions: Sequence[Preference],
    overall: Sequence[Preference],
    segments: Sequence[SegmentShare],
    *,
    name: str,
    mark: str,
) -> Markup:
    """Draw one comparison: a panel per question, a row per emotion, all of them last.

    Parameters
    ----------
    emotions : sequence of Preference
        Estimates within emotions, of one comparison.
    overall : sequence of Preference
        The comparison's estimates over all emotions, one per question; they set the panels.
    segments : sequence of SegmentShare
        The comparison's single segments, drawn as ticks under the row of their emotion.
    name : str
        Prefix of the figure's ids.
    mark : str
        Written into a corner, so that a copied figure keeps it; empty for none.
    """
    labels = list(dict.fromkeys(p.emotion for p in emotions))
    rows = len(labels) + 1
    reference, other = wording.name(overall[0].reference), wording.name(overall[0].other)
    hints: dict[str, str] = {}
    with mpl.rc_context({**STYLE, "font.size": 10.0}):
        height = 0.3 * rows + (1.45 if mark else 1.25)
        figure = Figure(figsize=(10.0, height))
        panels = figure.subplots(1, len(overall), squeeze=False, sharey=True)[0]
        figure.subplots_adjust(
            left=0.125,
            right=0.965,
            top=1 - (0.68 if mark else 0.48) / height,
            bottom=0.68 / height,
            wspace=0.12,
        )
        for number, (axes, whole) in enumerate(zip(panels, overall, strict=True)):
            within = [p for p in emotions if p.question == whole.question]
            for row, preference in enumerate([*within, whole]):
                gid = f"row{number}-{row}"
                _estimate(axes, row, preference, gid)
                hints[gid] = (
                    f"{preference.emotion or 'all emotions'}: "
                    f"{wording.estimate(preference.win_share)}, "
                    f"{wording.count(preference.win_share.segments, 'segment')}"
                )
            ticks = [s for s in segments if s.question == whole.question]
            axes.plot(
                [tick.win_share for tick in ticks],
                [labels.index(tick.emotion) + 0.25 for tick in ticks],
                linestyle="none",
                marker="|",
                markersize=5.5,
                markeredgewidth=1.1,
                color="#565d66",
                zorder=2,
            )
            axes.axhline(rows - 1.5, color="#c7ccd2", linewidth=0.8)
            axes.axvline(0.5, color="#22262b", linewidth=0.8, zorder=1)
            axes.set_xlim(-0.02, 1.02)
            axes.set_ylim(rows - 0.5, -0.5)
            axes.set_xticks([0, 0.25, 0.5, 0.75, 1], labels=["0", ".25", ".5", ".75", "1"])
            axes.set_yticks(range(rows), labels=[*labels, "all emotions"])
            axes.tick_params(axis="y", length=0)
            axes.set_title(
                wording.heading(whole.question),
                loc="left",
                fontsize=11.5,
                fontweight="bold",
                pad=8,
            )
            axes.set_xlabel(f"win share of {reference} against {other}", fontsize=9)
        if mark:
            figure.text(
                0.125,
                1 - 0.02 / height,
                mark,
                va="top",
                color="#8a3500",
                fontsize=9,
                fontweight="bold",
            )
        alt = (
            f"Win share of {reference} against {other} within each emotion; "
            "the numbers are in emotions.csv."
        )
        return inline_svg(figure, name=name, alt=alt, hints=hints)


def _estimate(axes: Axes, row: int, preference: Preference, gid: str) -> None:
    mean = preference.win_share
    if math.isnan(mean.estimate):
        axes.text(0.5, row, "no answers", ha="center", va="center", fontsize=9)
        return
    firm = mean.segments >= FEW_SEGMENTS
    if not mean.reason:
        axes.plot(
            [mean.low, mean.high],
            [row, row],
            color=_INK,
            linewidth=1.6 if firm else 1.0,
            solid_capstyle="butt",
            zorder=2,
        )
    axes.plot(
        [mean.estimate],
        [row],
        marker="o" if preference.emotion else "D",
        markersize=6.5,
        markerfacecolor=_INK if firm else "white",
        markeredgecolor=_INK,
        zorder=3,
        gid=gid,
    )
