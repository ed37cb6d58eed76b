"""Nothing written in a figure is cut off, and no words lie on others."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import combinations
from types import ModuleType
from typing import Any

import matplotlib as mpl
import pytest
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from analysis.report.content import Picture
from analysis.report.figures import matrix_figure, panel_figure
from analysis.report.figures.bar_figure import Bar, BarFigure, Part, bar_pictures
from analysis.report.figures.dot_figure import Dot, dot_pictures
from analysis.report.figures.ink import FIVE, STYLE
from analysis.report.figures.matrix_figure import Won, matrix_pictures
from analysis.report.figures.panels import RowName, Scale
from analysis.report.figures.rating_figures import cumulative_pictures
from analysis.report.figures.svg import Drawing
from analysis.results.rating import RatedCondition

Drawn = Callable[[ModuleType], list[Figure]]

LONG = "a condition whose name is so long that it has to be broken into several lines"
FIXED: dict[str, Any] = {"name": "n", "title": "t", "caption": "c", "data": "", "mark": "Rehearsal"}


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Drawn:
    """Return what keeps the figures that a module draws, before they are written."""

    def keep(module: ModuleType) -> list[Figure]:
        figures: list[Figure] = []

        def picture(figure: Figure, *, narrow: Drawing, **_: object) -> Picture:
            figures.extend([figure, narrow.figure])
            return Picture(svg=Markup(""), caption="")

        monkeypatch.setattr(module, "picture", picture)
        return figures

    return keep


def texts(figure: Figure) -> Iterator[tuple[Text, mpl.transforms.BboxBase]]:
    # As in files and on pages, letters are as wide as their font says, not whole pixels.
    figure.set_dpi(288)
    with mpl.rc_context({**STYLE, "text.hinting": "no_hinting"}):
        renderer = FigureCanvasAgg(figure).get_renderer()
        figure.draw(renderer)
        for text in figure.findobj(Text):
            if isinstance(text, Text) and text.get_text().strip() and text.get_visible():
                yield text, text.get_window_extent(renderer)


def check(figures: list[Figure]) -> None:
    assert figures
    for figure in figures:
        room = figure.bbox
        found = list(texts(figure))
        for text, box in found:
            assert box.x0 >= -4, text
            assert box.y0 >= -4, text
            assert box.x1 <= room.x1 + 4, text
            assert box.y1 <= room.y1 + 4, text
        for (one, first), (other, second) in combinations(found, 2):
            # Boxes are as high as the tallest letter; words may come as close as their lines.
            wide = min(first.x1, second.x1) - max(first.x0, second.x0)
            high = min(first.y1, second.y1) - max(first.y0, second.y0)
            assert wide <= 4 or high <= 10, (one, other)


def rows(count: int) -> tuple[RowName, ...]:
    return tuple(RowName(name=f"{k} {LONG}", below="n = 1234") for k in range(count))


@pytest.mark.parametrize(("panels", "count"), [(1, 1), (2, 12), (3, 2)])
def test_bars(drawn: Drawn, panels: int, count: int) -> None:
    figures = drawn(panel_figure)
    bar = Bar(
        start=-60,
        parts=tuple(Part(percent=20.0, hint="") for _ in FIVE),
        estimate=0.98,
        low=0.9,
        high=1.0,
        words="12.34",
        below="[12.30, 12.40]",
    )
    questions = [f"question {k} {LONG}" for k in range(panels)]
    bar_pictures(
        BarFigure(
            panels=dict.fromkeys(questions, (bar,) * count),
            told=dict.fromkeys(questions, "told"),
            rows=rows(count),
            colours=FIVE,
            legend=tuple(f"slightly {k} {LONG}" for k in range(5)),
            bars=Scale(
                limits=(-60, 60), ticks={-60: "60 %", 0: "0", 60: "60 %"}, ends=(LONG, LONG)
            ),
            estimates=Scale(limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share"),
        ),
        **FIXED,
    )
    check(figures)


@pytest.mark.parametrize(("panels", "count"), [(1, 3), (4, 12)])
def test_dots(drawn: Drawn, panels: int, count: int) -> None:
    figures = drawn(panel_figure)
    questions = [f"question {k} {LONG}" for k in range(panels)]
    dot = Dot(estimate=-1.5, low=-2.0, high=2.0, words="−12.34", below="rank 10–12")
    dot_pictures(
        {question: [dot] * count for question in questions},
        rows(count),
        Scale(limits=(-2, 2), ticks={-2: "−2", 0: "0", 2: "2"}, label="strength in logits"),
        told=dict.fromkeys(questions, "told"),
        **FIXED,
    )
    check(figures)


@pytest.mark.parametrize("count", [2, 12])
def test_matrices(drawn: Drawn, count: int) -> None:
    figures = drawn(matrix_figure)
    names = [f"{k} {LONG}" for k in range(count)]
    shares = {
        (one, other): Won(share=1.0, words="", decided=True)
        for one in names
        for other in names
        if one != other
    }
    matrix_pictures({f"question {LONG}": shares, "another": shares}, names, **FIXED)
    check(figures)


def test_curves(drawn: Drawn) -> None:
    figures = drawn(panel_figure)
    conditions = [
        RatedCondition(
            set=None,
            condition=f"{k} {LONG}",
            question=question,
            n=10,
            estimate=3.0,
            sd=1.0,
            low=2.0,
            high=4.0,
            counts=dict.fromkeys(range(1, 6), 2),
            at_least={score: 120.0 - 20 * score for score in range(1, 6)},
            participants=2,
            segments=2,
        )
        for question in ("match", "sync")
        for k in range(12)
    ]
    cumulative_pictures(conditions, name="c", data="", mark="Rehearsal")
    check(figures)
