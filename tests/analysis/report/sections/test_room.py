"""No text in a figure is cut off or overlaps another."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any, cast

import matplotlib as mpl
import pytest
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from analysis.metrics.scores import Better
from analysis.report.content import FigureText, Picture
from analysis.report.figures import panels
from analysis.report.figures.estimates import (
    Bar,
    Dot,
    MatrixCell,
    Part,
    bar_pictures,
    dot_pictures,
    matrix_pictures,
)
from analysis.report.figures.panels import Row
from analysis.report.figures.style import DIVERGING, STYLE, Drawing, Scale
from analysis.report.sections.against_people import agreement_pictures
from analysis.results.against_people import MetricAgainstPeople, ScoredCondition
from analysis.stats.clustered_mean import Estimate

LONG = "a condition whose name is so long that it has to be broken into several lines"
TEXT = FigureText(name="n", title="t", caption="c", mark="Rehearsal")
NONE = cast(Any, None)


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures that are drawn, wide and narrow, before they are written."""
    figures: list[Figure] = []

    def make_picture(wide: Drawing, narrow: Drawing, text: FigureText, description: str) -> Picture:
        figures.extend([wide.figure, narrow.figure])
        return Picture(svg=Markup(""), caption="")

    monkeypatch.setattr(panels, "make_picture", make_picture)
    return figures


def texts(figure: Figure) -> Iterator[tuple[Text, mpl.transforms.BboxBase]]:
    # As in files and on pages, letters are as wide as their font says, not whole pixels.
    figure.set_dpi(288)
    with mpl.rc_context({**STYLE, "text.hinting": "no_hinting"}):
        renderer = FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]  # matplotlib has no types for it
        figure.draw(renderer)
        beyond = {
            id(tick.label1)
            for axes in figure.axes
            for axis in (axes.xaxis, axes.yaxis)
            for tick in axis.get_major_ticks()
            if not min(axis.get_view_interval()) <= tick.get_loc() <= max(axis.get_view_interval())
        }
        for text in figure.findobj(Text):
            if not isinstance(text, Text) or id(text) in beyond:
                continue
            if text.get_text().strip() and text.get_visible():
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


def rows(count: int) -> tuple[Row, ...]:
    return tuple(Row(f"{k} {LONG}", "n = 1234") for k in range(count))


@pytest.mark.parametrize(("questions", "count"), [(1, 1), (2, 12), (3, 2)])
def test_bars(drawn: list[Figure], questions: int, count: int) -> None:
    bar = Bar(
        start=-60,
        parts=tuple(Part(percent=20.0, colour=colour, hint="") for colour in DIVERGING),
        estimate=Estimate(estimate=0.98, low=0.9, high=1.0),
        formatted=lambda value: f"{11.5 + value:.2f}",
    )
    bar_pictures(
        {f"question {k} {LONG}": (bar,) * count for k in range(questions)},
        rows(count),
        {f"slightly {k} {LONG}": colour for k, colour in enumerate(DIVERGING)},
        Scale(limits=(-60, 60), ticks={-60: "60%", 0: "0", 60: "60%"}, ends=(LONG, LONG)),
        Scale(limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share"),
        TEXT,
    )
    check(drawn)


@pytest.mark.parametrize(("questions", "count"), [(1, 3), (4, 12)])
def test_dots(drawn: list[Figure], questions: int, count: int) -> None:
    dot = Dot(estimate=-1.5, low=-2.0, high=2.0, words="−12.34", below="rank 10–12")
    dot_pictures(
        {f"question {k} {LONG}": [dot] * count for k in range(questions)},
        rows(count),
        Scale(label="strength in logits", line=0.0),
        TEXT,
    )
    check(drawn)
    for axes in drawn[0].axes:
        low, high = axes.get_xlim()
        assert low < dot.low
        assert dot.high < high


def test_several_dots_in_a_row(drawn: list[Figure]) -> None:
    dots = [Dot(estimate=0.2, low=-0.5, high=0.8), Dot(estimate=0.9), Dot()]
    dot_pictures(
        {"over conditions": [dots] * 20, "within conditions": [dots] * 20},
        [Row(f"{k} {LONG}") for k in range(20)],
        Scale(limits=(-1, 1), ends=("disagrees", "agrees")),
        TEXT,
        series=[f"question {k} {LONG}" for k in range(3)],
    )
    check(drawn)


@pytest.mark.parametrize("count", [2, 12])
def test_matrices(drawn: list[Figure], count: int) -> None:
    names = [f"{k} {LONG}" for k in range(count)]
    shares = {
        (one, other): MatrixCell(share=1.0, words="", is_significant=True)
        for one in names
        for other in names
        if one != other
    }
    matrix_pictures({f"question {LONG}": shares, "another": shares}, names, TEXT)
    check(drawn)


def test_metrics_beside_preference(drawn: list[Figure]) -> None:
    names = [f"{k} {LONG}" for k in range(12)]
    directions: tuple[Better, ...] = ("higher", "lower", "near the reference", "lower")
    metrics = [
        MetricAgainstPeople(
            metric=f"metric {k} {LONG}",
            unit="m/s",
            better=better,
            conditions=12,
            recorded=0.3,
            left_out={},
            places=tuple(
                ScoredCondition(
                    condition=name, score=123.4 * at, preference=-at, low=-at - 1, high=-at + 1
                )
                for at, name in enumerate(names)
            ),
            kendall=NONE,
            spearman=NONE,
            within=NONE,
        )
        for k, better in enumerate(directions)
    ]
    agreement_pictures(metrics, names, "strength (logits)", TEXT)
    check(drawn)
