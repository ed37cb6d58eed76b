"""Figures of panels: on sheets for a page, and once more in one column for a narrow screen."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import matplotlib as mpl
from matplotlib.artist import Artist

from analysis.report import wording
from analysis.report.content import Picture
from analysis.report.figures.ink import STYLE
from analysis.report.figures.legend import draw_legend, legend_entries
from analysis.report.figures.panels import (
    NARROW,
    WIDE,
    Format,
    Place,
    Plan,
    RowName,
    numbered,
    plans,
    write_names,
    write_title,
)
from analysis.report.figures.sheet import Sheet
from analysis.report.figures.svg import Drawing, picture

Hints = dict[str, str]


@dataclass(frozen=True, kw_only=True)
class PanelFigure:
    """What a figure shows, whatever its panels draw.

    Attributes
    ----------
    told : mapping of str to str
        By question, or whatever else heads a panel: what it shows in words, with the numbers.
    rows : tuple of RowName
        From the top; the same in every panel.
    draw : callable
        Draws the panel of a question in its place, and returns its hover texts by gid.
    legend : tuple of str
        Words under the figure; () for none.
    signs : callable
        Returns the signs of the legend, given its words.
    """

    told: Mapping[str, str]
    rows: tuple[RowName, ...]
    draw: Callable[[Sheet, Place, str], Hints]
    legend: tuple[str, ...] = ()
    signs: Callable[[Sequence[str]], Sequence[Artist]] = lambda words: ()


def panel_pictures(
    figure: PanelFigure, *, name: str, title: str, caption: str, data: str, mark: str
) -> tuple[Picture, ...]:
    """Draw a figure on as many sheets as it needs.

    Parameters
    ----------
    figure : PanelFigure
        What it shows.
    name, title, caption, data
        See `analysis.report.figures.svg.picture`.
    mark : str
        Written on top; empty for none.
    """
    questions = tuple(figure.told)
    sheets = _plans(figure, questions, WIDE)
    found = []
    for number, (plan, own_name) in enumerate(
        zip(sheets, numbered(name, len(sheets)), strict=True), start=1
    ):
        which = f" ({number} of {len(sheets)})" if len(sheets) > 1 else ""
        shown = [questions[place.number] for place in plan.places]
        (narrow,) = _plans(figure, shown, NARROW)
        with mpl.rc_context(STYLE):
            wide = _drawn(figure, plan, questions, mark, WIDE)
            found.append(
                picture(
                    wide.figure,
                    hints=wide.hints,
                    narrow=_drawn(figure, narrow, shown, mark, NARROW),
                    name=own_name,
                    title=title,
                    alt=" ".join(figure.told[question] for question in shown),
                    caption=f"{caption}{which}",
                    data=data,
                )
            )
    return tuple(found)


def _plans(figure: PanelFigure, questions: Sequence[str], room: Format) -> list[Plan]:
    titles = [wording.heading(question) for question in questions]
    foot = legend_entries(figure.legend, room.width).height if figure.legend else 0.0
    return plans(titles, figure.rows, foot=foot, room=room)


def _drawn(
    figure: PanelFigure, plan: Plan, questions: Sequence[str], mark: str, room: Format
) -> Drawing:
    hints: Hints = {}
    sheet = Sheet(plan.height, mark=mark, width=room.width)
    for place in plan.places:
        question = questions[place.number]
        write_title(sheet, place, wording.heading(question))
        write_names(sheet, place, figure.rows, room)
        hints |= figure.draw(sheet, place, question)
    if figure.legend:
        entries = legend_entries(figure.legend, room.width)
        draw_legend(sheet, figure.signs(entries.words), entries)
    return Drawing(figure=sheet.figure, hints=hints)
