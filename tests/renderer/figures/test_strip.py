from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from motion.audio import Audio
from renderer.figures.plate import Plate, font
from renderer.figures.strip import Moment, StripLayout, draw_strip, loud_moments
from tests.support.sounds import tone

RATE = 8000

MOMENTS = (Moment(seconds=0.4, word="no"), Moment(seconds=1.1), Moment(seconds=1.9, word="never"))
SPEECH = tone(2)
COLOURS = {"ours": (0, 90, 160), "theirs": (230, 150, 0)}


def speech(*syllables: float, seconds: float = 4.0) -> Audio:
    """Return silence with a short hum at each of `syllables`."""
    times = np.arange(round(seconds * RATE)) / RATE
    loud = np.zeros_like(times)
    for at in syllables:
        loud = np.maximum(loud, np.exp(-0.5 * ((times - at) / 0.05) ** 2))
    return Audio((0.5 * loud * np.sin(2 * np.pi * 200 * times)).astype(np.float32), RATE)


def test_a_moment_may_have_a_keyword() -> None:
    assert Moment.parse("2.4") == Moment(seconds=2.4)
    assert Moment.parse("never=2.4") == Moment(seconds=2.4, word="never")
    assert Moment.parse("a = b=1") == Moment(seconds=1, word="a = b")
    assert (Moment.parse("2.44").label, Moment.parse("no=1").label) == ("2.4 s", "no")


def test_loud_moments_are_the_stressed_syllables() -> None:
    result = loud_moments(speech(0.5, 1.6, 2.2, 3.5), 4)
    assert [moment.seconds for moment in result] == pytest.approx([0.5, 1.6, 2.2, 3.5], abs=0.03)


@given(st.lists(st.floats(0, 4), max_size=12), st.integers(1, 16))
def test_no_syllable_is_shown_twice(syllables: list[float], count: int) -> None:
    result = [moment.seconds for moment in loud_moments(speech(*syllables), count)]
    assert len(result) == count
    assert np.diff(result).min(initial=np.inf) >= 4.0 / count / 2 - 0.02


def layout(**changes: object) -> StripLayout:
    given = {"inches": 2.0, "rows": ("ours", "theirs"), "moments": MOMENTS, "aspect": 1.25}
    return StripLayout(**(given | changes))  # type: ignore[arg-type]


def strip(*, clear: bool = False, **changes: object) -> Plate:
    shape = layout(**changes)
    panels = {
        (row, moment): Image.new("RGBA", shape.panel, COLOURS.get(row))
        for row in shape.rows
        for moment in shape.moments
    }
    return draw_strip(shape, panels, SPEECH, clear=clear)


def test_there_is_a_panel_per_condition_and_keyword() -> None:
    page = strip()
    pictures = [axes.images[0] for axes in page.figure.axes if axes.images]
    assert len(pictures) == 6
    texts = [text.get_text() for text in page.figure.texts]
    assert {"ours", "theirs", "“no”", "1.1 s", "“never”"} <= set(texts)


@pytest.mark.parametrize("clear", [False, True])
def test_the_print_width_is_exact_and_panels_are_not_resampled(tmp_path: Path, clear: bool) -> None:
    page = strip(clear=clear)
    page.save([tmp_path / "strip.png"])
    with Image.open(tmp_path / "strip.png") as image:
        assert image.size == (page.width, page.height)
        assert page.width == pytest.approx(600, abs=3)
        assert image.info["dpi"] == pytest.approx((300, 300), abs=0.1)
        corner = image.convert("RGBA").getpixel((0, page.height - 1))
        assert corner == (255, 255, 255, 0 if clear else 255)
        pixels = np.asarray(image.convert("RGB"))
    width, height = layout().panel
    for colour in COLOURS.values():
        assert (pixels == colour).all(axis=-1).sum() == 3 * width * height


@pytest.mark.parametrize("inches", [1.0, 2.0, 6.9])
def test_no_text_covers_another_or_leaves_the_page(inches: float) -> None:
    moments = tuple(Moment(seconds=k / 10, word="an enormous breakfast") for k in range(4))
    page = strip(inches=inches, rows=("x" * 40, "y" * 40), moments=moments)
    extents = [text.get_window_extent() for text in page.figure.texts]
    for extent in extents:
        assert extent.x0 >= -1 and extent.x1 <= page.width + 1
        assert extent.y0 >= -1 and extent.y1 <= page.height + 1
    for one, other in combinations(extents, 2):
        assert not one.overlaps(other)


def test_a_pdf_has_text_and_pictures_and_names_no_program(tmp_path: Path) -> None:
    strip().save([tmp_path / "strip.pdf"])
    data = (tmp_path / "strip.pdf").read_bytes()
    assert data.count(b"/Subtype /Image") >= 6
    assert b"DejaVuSans" in data
    assert b"/CreationDate" not in data
    assert b"/Creator" not in data


def test_text_is_drawn_without_system_fonts() -> None:
    for sign in "Ğéßλж–“→":
        assert font(20).getmask(sign).getbbox() is not None
        assert bytes(font(20).getmask(sign)) != bytes(font(20).getmask("\U0001f9ff"))
