from __future__ import annotations

import re

import matplotlib as mpl
import pytest
from bs4 import BeautifulSoup
from matplotlib.figure import Figure

from analysis.report.content import FigureText, Picture
from analysis.report.figures.style import (
    DIVERGING,
    INK,
    PAGE_COLOURS,
    SERIES,
    STYLE,
    Drawing,
    make_picture,
    place_colours,
    scale_colours,
    text_colour,
)


def drawn() -> Picture:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(2, 1))
        axes = figure.subplots()
        axes.plot([0, 1], [0, 1], gid="line")
        axes.set_title("条件 a < b & c")
        drawing = Drawing(figure=figure, hints={"line": "<i>1</i> < 2"})
        text = FigureText(name="one", title="", caption="")
        return make_picture(drawing, drawing, text, "")


def test_letters_of_every_script_are_drawn_without_a_warning_and_signs_are_no_markup() -> None:
    svg = BeautifulSoup(drawn().svg, "html.parser").svg
    assert svg is not None
    assert "条件 a < b & c" in [text.get_text() for text in svg("text")]
    assert "<i>1</i> < 2" in [hint.get_text() for hint in svg("title")]


def test_words_and_lines_follow_the_colours_of_the_page() -> None:
    svg = drawn().svg
    assert PAGE_COLOURS[INK] in svg
    assert not any(re.search(rf"(?<!, ){colour}", svg) for colour in PAGE_COLOURS)


@pytest.mark.parametrize("colour", [*DIVERGING, *SERIES, *place_colours(12), *scale_colours(21)])
def test_words_on_a_coloured_part_can_be_read(colour: str) -> None:
    light, dark = sorted((_luminance(colour), _luminance(text_colour(colour))), reverse=True)
    assert (light + 0.05) / (dark + 0.05) >= 3


def _luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255 for k in (1, 3, 5)]
    linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
