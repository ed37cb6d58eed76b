from __future__ import annotations

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from analysis.report.figures.sheet import POINTS, Sheet, fitted

NAMES = (
    "AMUSE",
    "a reference with a name of many words that goes on and on",
    "Averyveryverylongconditionnamewithoutanyspacesinit",
    "two wordsthatarefartoolongforonelineofthis",
    "Überraschung WWWWWWWWWWWWWW",
)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("lines", [1, 2, 3])
def test_words_never_need_more_room_than_there_is(name: str, lines: int) -> None:
    found = fitted(name, 1.1, size=8, lines=lines).split("\n")
    assert len(found) <= lines
    for line in found:
        font = FontProperties(family="DejaVu Sans", size=8)
        width, _, _ = TextToPath().get_text_width_height_descent(line, font, ismath=False)
        assert width / POINTS <= 1.1 + 1e-6


def test_words_that_fit_stay_as_they_are() -> None:
    assert fitted("no difference", 2, size=8) == "no difference"
    assert fitted("", 2, size=8) == ""


def test_words_that_are_cut_end_in_dots() -> None:
    assert fitted(NAMES[1], 1, size=8).endswith("…")
    assert "…" not in fitted(NAMES[1], 1, size=8, lines=9)


def test_panels_stand_where_they_are_put_whether_there_is_a_mark_or_not() -> None:
    for mark in ("", "Rehearsal: nobody answered"):
        sheet = Sheet(4.0, mark=mark, width=5.0)
        axes = sheet.panel(1.0, 0.5, 2.0, 1.0)
        height = sheet.figure.get_figheight()
        place = axes.get_position()
        assert place.x0 * 5 == pytest.approx(1.0)
        assert place.width * 5 == pytest.approx(2.0)
        assert place.height * height == pytest.approx(1.0)
        assert (1 - place.y1) * height - (height - 4.0) == pytest.approx(0.5)
        assert [text.get_text() for text in sheet.figure.texts] == ([mark] if mark else [])
