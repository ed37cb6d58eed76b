from pathlib import Path

import numpy as np
from PIL import Image, ImageColor

from renderer.figures.overlay import VARIATION_COLOURS, blended, draw_overlay, faded
from renderer.figures.panels import NO_DEPTH, CutOut

RED, GREEN, GREY = (200, 0, 0, 255), (0, 200, 0, 255), (120, 120, 120, 255)


def square(colour: tuple[int, int, int, int], left: int, depth: float) -> CutOut:
    """Return a square of 10 pixels in a picture of 40 × 20, so far from the camera."""
    picture = Image.new("RGBA", (40, 20))
    picture.paste(colour, (left, 5, left + 10, 15))
    depths = np.full((20, 40), NO_DEPTH, np.float32)
    depths[5:15, left : left + 10] = depth
    return CutOut(picture, depths)


def at(figure: CutOut, x: int) -> tuple[int, ...]:
    return tuple(np.asarray(figure.picture)[10, x].tolist())


def test_older_moments_are_fainter_and_the_newest_is_opaque() -> None:
    trail = faded([square(RED, left, 3.0) for left in (0, 15, 28)])
    strengths = [at(trail, x)[3] for x in (5, 20, 33)]
    assert 30 < strengths[0] < strengths[1] < strengths[2] == 255
    assert at(trail, 5)[:3] == RED[:3]
    assert at(trail, 12)[3] == 0


def test_a_hand_in_front_of_the_body_leaves_its_trail() -> None:
    body, hand = square(GREEN, 10, 3.0), square(RED, 10, 2.6)
    assert at(faded([hand, body]), 15)[0] > 40
    assert at(faded([body, hand]), 15) == RED


def test_the_latest_of_figures_at_equal_depth_is_on_top() -> None:
    assert at(faded([square(RED, 10, 2.98), square(GREEN, 10, 3.0)]), 15) == GREEN


def test_variations_have_the_colour_of_their_legend_only_where_they_differ() -> None:
    both = blended([square(GREY, 0, 3.0), square(GREY, 20, 3.0)])
    for x, colour in zip((5, 25), VARIATION_COLOURS, strict=False):
        expected = np.array(ImageColor.getrgb(colour))
        result = np.array(at(both, x)[:3])
        assert np.argmax(result) == np.argmax(expected)
        assert np.ptp(result) > 60
    shared = blended([square(RED, 10, 3.0), square(RED, 10, 3.0)])
    assert np.abs(np.array(at(shared, 15)[:3]) - RED[:3]).max() <= 2


def test_no_variation_covers_another() -> None:
    one = blended([square(RED, 5, 3.0), square(RED, 10, 3.0)]).picture
    other = blended([square(RED, 10, 3.0), square(RED, 5, 3.0)]).picture
    np.testing.assert_array_equal(one.getchannel("A"), other.getchannel("A"))


def test_the_page_has_a_legend_and_the_moments() -> None:
    page = draw_overlay(Image.new("RGBA", (300, 200)), ["ours", "theirs"], "1.2 s", clear=True)
    assert [text.get_text() for text in page.figure.texts] == ["ours", "theirs", "1.2 s"]
    swatches = [patch.get_facecolor() for axes in page.figure.axes for patch in axes.patches]
    assert len(set(swatches)) == 2
    assert page.width == 300


def test_figures_are_drawn_on_the_videos_background(tmp_path: Path) -> None:
    dark, path = (0x2E, 0x34, 0x40), tmp_path / "overlay.png"
    picture = Image.new("RGBA", (300, 200))
    draw_overlay(picture, ["ours"], "1.2 s", clear=False, background=dark).save([path])
    with Image.open(path) as image:
        assert image.convert("RGB").getpixel((150, 100)) == dark
