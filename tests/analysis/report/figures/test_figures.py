from __future__ import annotations

import re

import matplotlib as mpl
import pytest
from bs4 import BeautifulSoup
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from analysis.report.content import FigureText, Picture
from analysis.report.figures.estimates import Dot, dot_pictures
from analysis.report.figures.panels import WIDE, Row
from analysis.report.figures.style import (
    DIVERGING,
    INK,
    PAGE_COLOURS,
    POINTS_PER_INCH,
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
from tests.analysis.report.sections.reading import drawn

SCALE = Scale(limits=(0, 1), ticks={0: "0", 1: "1"}, label="win share")
TEXT = FigureText(name="forest", title="A forest", caption="Effects.")

NAMES = (
    "AMUSE",
    "a reference with a name of many words that goes on and on",
    "Averyveryverylongconditionnamewithoutanyspacesinit",
    "two wordsthatarefartoolongforonelineofthis",
    "Überraschung WWWWWWWWWWWWWW",
)


def test_marks_distinguish_descriptive_rows_and_totals() -> None:
    dots = [
        Dot(estimate=0.4, low=0.1, high=0.7, words=".40", hint=".40", is_descriptive=True),
        Dot(estimate=0.5, low=0.3, high=0.7, words=".50", hint=".50", is_overall=True),
    ]
    text = FigureText(name="forest", title="A forest", caption="", mark="Rehearsal")

    (picture,) = dot_pictures({"emotion": dots}, [Row("anger"), Row("all")], SCALE, text)

    svg = drawn(picture)
    hollow, full = (svg.find(id=f"forest-dot0-{row}") for row in (0, 1))
    assert "var(--paper" in str(hollow)
    assert "var(--paper" not in str(full)
    assert {"anger", "all", "Rehearsal", "win share"} <= {t.get_text() for t in svg("text")}
    assert svg.desc is not None
    assert svg.desc.get_text() == "Emotion. anger: .40; all: .50."


def test_narrow_screens_stack_the_same_panels() -> None:
    dots = [Dot(estimate=0.4, low=0.1, high=0.7, words=".40", hint=".40")]

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
    dots = [Dot(estimate=0.4, hint=".40")] * 12
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
def test_text_fits_its_space(name: str, lines: int) -> None:
    fitting = fit_text(name, 1.1, size=8, lines=lines).split("\n")
    assert len(fitting) <= lines
    is_whole = "".join(fitting).replace(" ", "") == name.replace(" ", "")
    assert is_whole == ("…" not in fitting[-1])
    for line in fitting:
        font = FontProperties(family="DejaVu Sans", size=8)
        width, _, _ = TextToPath().get_text_width_height_descent(line, font, ismath=False)
        assert width / POINTS_PER_INCH <= 1.1 + 1e-6


def line_picture() -> Picture:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(2, 1))
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], gid="line")
        axes.set_title("条件 a < b & c")
        drawing = Drawing(figure=figure, hints={"line": "<i>1</i> < 2"})
        text = FigureText(name="one", title="", caption="")
        return make_picture(drawing, drawing, text, "")


def test_every_script_is_drawn_and_special_characters_are_not_markup() -> None:
    svg = BeautifulSoup(line_picture().svg, "html.parser").svg
    assert svg is not None
    assert "条件 a < b & c" in [text.get_text() for text in svg("text")]
    assert "<i>1</i> < 2" in [hint.get_text() for hint in svg("title")]


def test_text_and_lines_follow_the_pages_colours() -> None:
    svg = line_picture().svg
    assert PAGE_COLOURS[INK] in svg
    assert not any(re.search(rf"(?<!, ){colour}", svg) for colour in PAGE_COLOURS)


@pytest.mark.parametrize("colour", [*DIVERGING, *SERIES, *place_colours(12), *scale_colours(21)])
def test_text_on_coloured_bars_is_legible(colour: str) -> None:
    light, dark = sorted((_luminance(colour), _luminance(text_colour(colour))), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 3


def _luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
