from __future__ import annotations

import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextToPath

from analysis.report.figures.fitting import POINTS, fitted

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
