"""Figures say what they show, and no text in them is cut off or overlaps another."""

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import matplotlib as mpl
import numpy as np
import pytest
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text

from analysis.metrics.scores import Better
from analysis.report.content import FigureText, Picture
from analysis.report.figures import panels
from analysis.report.figures.estimates import (
    Dot,
    MatrixCell,
    Part,
    bar_of,
    bar_pictures,
    dot_pictures,
    matrix_pictures,
)
from analysis.report.figures.panels import WIDE, Row
from analysis.report.figures.style import (
    BLUE,
    DIVERGING,
    INK,
    PAGE_COLOURS,
    PAPER,
    SERIES,
    STYLE,
    Drawing,
    Scale,
    fit_text,
    make_picture,
    place_colours,
    scale_colours,
    text_colour,
)
from analysis.report.sections.against_people import agreement_pictures
from analysis.report.wording import labelled
from analysis.results.against_people import against_people
from analysis.stats.clustered_mean import Estimate
from tests.analysis.report.sections.reading import drawn, told
from tests.analysis.results.simulated_studies import AgreeingStudy

SCALE = Scale(limits=(0, 1), ticks={0: "0", 1: "1"}, label="win share")
TEXT = FigureText(name="forest", title="A forest", caption="Effects.")
LONG = "a condition whose name is so long that it has to be broken into several lines"

NAMES = (
    "AMUSE",
    "a reference with a name of many words that goes on and on",
    "Averyveryverylongconditionnamewithoutanyspacesinit",
    "two wordsthatarefartoolongforonelineofthis",
    "Überraschung WWWWWWWWWWWWWW",
)


def test_marks_distinguish_descriptive_rows_and_totals() -> None:
    dots = [
        Dot(estimate=0.4, low=0.1, high=0.7, words=".40", in_full=".40", is_descriptive=True),
        Dot(estimate=0.5, low=0.3, high=0.7, words=".50", in_full=".50", is_overall=True),
    ]

    with labelled({}, mark="Rehearsal"):
        (picture,) = dot_pictures({"emotion": dots}, [Row("anger"), Row("all")], SCALE, TEXT)

    svg = drawn(picture)
    assert picture.figure is not None
    marks = [line for line in picture.figure.axes[0].lines if line.get_marker() in ("o", "D")]
    assert [line.get_markerfacecolor() for line in marks] == [PAPER, BLUE]
    assert {"anger", "all", "Rehearsal", "win share"} <= {t.get_text() for t in svg("text")}
    assert svg.desc is not None
    assert svg.desc.get_text() == "Emotion. anger: .40; all: .50."


def test_narrow_screens_stack_the_same_panels() -> None:
    dots = [Dot(estimate=0.4, low=0.1, high=0.7, words=".40", in_full=".40")]

    (picture,) = dot_pictures({"emotion": dots, "rhythm": dots}, [Row("ours")], SCALE, TEXT)

    wide, narrow = (drawn(picture, place) for place in (0, 1))
    assert (wide["class"], narrow["class"]) == (["wide"], ["narrow"])
    sizes = [list(map(float, str(svg["viewbox"]).split()))[2:] for svg in (wide, narrow)]
    assert sizes[0][0] > 1.5 * sizes[1][0]
    assert sizes[0][1] < sizes[1][1]
    said = [sorted({text.get_text() for text in svg("text")}) for svg in (wide, narrow)]
    assert said[0] == said[1]
    ids = [{tag["id"] for tag in svg(id=True)} for svg in (wide, narrow)]
    assert not ids[0] & ids[1]


def test_panels_that_do_not_fit_continue_on_further_sheets() -> None:
    dots = [Dot(estimate=0.4, in_full=".40")] * 12
    questions = [f"question {number}" for number in range(5)]

    pictures = dot_pictures(dict.fromkeys(questions, dots), [Row("ours")] * 12, SCALE, TEXT)

    assert [picture.name for picture in pictures] == ["forest-1", "forest-2"]
    assert pictures[1].caption == "Effects. (2 of 2)"
    shown = [text.get_text() for picture in pictures for text in drawn(picture)("text")]
    assert [text for text in shown if text.startswith("Question")] == [
        question.capitalize() for question in questions
    ]
    for picture in pictures:
        height = float(str(drawn(picture)["viewbox"]).split()[3]) / 72
        assert height <= WIDE.max_height


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lines", [1, 2, 3])
def test_only_text_that_does_not_fit_is_shortened(name: str, lines: int) -> None:
    fitting = fit_text(name, 1.1, size=8, lines=lines).split("\n")
    assert len(fitting) <= lines
    is_whole = "".join(fitting).replace(" ", "") == name.replace(" ", "")
    assert is_whole == ("…" not in fitting[-1])


def test_both_conditions_of_a_row_are_named() -> None:
    pair = "ours without emotion against ground truth"
    assert Row(pair).text(WIDE).split() == pair.split()


def test_every_script_is_drawn_without_markup_and_in_the_pages_colours() -> None:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(2, 1))
        figure.subplots().set_title("条件 a < b & c")
        drawing = Drawing(figure, "<i>1</i> < 2")
        picture = make_picture(drawing, drawing, FigureText(name="one", title="", caption=""))
    svg = drawn(picture)
    assert "条件 a < b & c" in [text.get_text() for text in svg("text")]
    assert told(picture) == "<i>1</i> < 2"
    assert PAGE_COLOURS[INK] in picture.svg
    assert not any(re.search(rf"(?<!, ){colour}", picture.svg) for colour in PAGE_COLOURS)


@pytest.mark.parametrize("colour", [*DIVERGING, *SERIES, *place_colours(12), *scale_colours(21)])
def test_text_on_coloured_bars_is_legible(colour: str) -> None:
    light, dark = sorted((_luminance(colour), _luminance(text_colour(colour))), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 3


def _luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Return the figures that are drawn, wide and narrow, before they are written."""
    kept: list[Figure] = []

    def make_picture(wide: Drawing, narrow: Drawing, text: FigureText) -> Picture:
        kept.extend([wide.figure, narrow.figure])
        return Picture(svg=Markup(""), caption="")

    monkeypatch.setattr(panels, "make_picture", make_picture)
    return kept


def texts(figure: Figure) -> Iterator[tuple[Text, mpl.transforms.BboxBase]]:
    # As in files and on pages, letters are as wide as their font says, not whole pixels.
    figure.set_dpi(288)
    with mpl.rc_context({**STYLE, "text.hinting": "no_hinting"}):
        FigureCanvasAgg(figure)
        figure.draw_without_rendering()
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
                yield text, text.get_window_extent()


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


@pytest.mark.parametrize(("questions", "count"), [(1, 1), (2, 12)])
def test_bars(figures: list[Figure], questions: int, count: int) -> None:
    bar = bar_of(
        [Part(20.0, "")] * 5,
        Estimate(estimate=0.98, low=0.9, high=1.0),
        lambda value: f"{11.5 + value:.2f}",
        start=-60,
    )
    bar_pictures(
        {f"question {k} {LONG}": (bar,) * count for k in range(questions)},
        rows(count),
        {f"slightly {k} {LONG}": colour for k, colour in enumerate(DIVERGING)},
        Scale(limits=(-60, 60), ticks={-60: "60%", 0: "0", 60: "60%"}, label=f"{LONG}, {LONG}"),
        Scale(limits=(0, 1), ticks={0: "0", 0.5: ".5", 1: "1"}, label="win share"),
        TEXT,
    )
    check(figures)


@pytest.mark.parametrize(("questions", "count", "series"), [(1, 3, 1), (4, 12, 1), (2, 20, 3)])
def test_dots(figures: list[Figure], questions: int, count: int, series: int) -> None:
    dot = Dot(estimate=-1.5, low=-2.0, high=2.0, words="−12.34", below="rank 10–12")
    bare = [replace(dot, words="", below=""), Dot(estimate=0.9), Dot()]
    dot_pictures(
        {f"question {k} {LONG}": [dot if series == 1 else bare] * count for k in range(questions)},
        rows(count) if series == 1 else [Row(row.name) for row in rows(count)],
        Scale(label="strength in logits", line=0.0),
        TEXT,
        series=[f"question {k} {LONG}" for k in range(series)] if series > 1 else (),
    )
    check(figures)
    for axes in figures[0].axes:
        low, high = axes.get_xlim()
        assert low < dot.low
        assert dot.high < high


@pytest.mark.parametrize("count", [2, 12])
def test_matrices(figures: list[Figure], count: int) -> None:
    names = [f"{k} {LONG}" for k in range(count)]
    shares = {
        (one, other): MatrixCell(share=1.0, words="", is_significant=True)
        for one in names
        for other in names
        if one != other
    }
    matrix_pictures({f"question {LONG}": shares, "another": shares}, names, TEXT)
    check(figures)


def test_metrics_beside_preference(figures: list[Figure]) -> None:
    study = AgreeingStudy(conditions=12).drawn(np.random.default_rng(1))
    [metric] = against_people("rating", *study, resamples=20).metrics
    directions: tuple[Better, ...] = ("higher", "lower", "near the reference", "lower")
    metrics = [
        replace(metric, metric=f"metric {k} {LONG}", better=better, recorded=0.3)
        for k, better in enumerate(directions)
    ]
    names = [place.condition for place in metric.places]
    with labelled({name: f"{name} {LONG}" for name in names}):
        agreement_pictures(metrics, names, "strength (logits)", TEXT)
    check(figures)
