"""An overlay: several moments or variations in one picture, from one camera."""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageColor

from motion.arrays import Floats32
from motion.errors import InputError
from renderer.figures.panels import CutOut
from renderer.figures.plate import LETTERS, Plate, fitted, font, pixels
from renderer.look import BACKGROUND, Colour

VARIATION_COLOURS: Final = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#8A8A8A",
)  # fmt: skip
"""Okabe and Ito's palette, distinguishable with any kind of colour vision."""

_MIN_STRENGTH: Final = 0.28
_SAME_DEPTH: Final = 0.05
"""Difference in depth up to which two figures count as being in the same place, in metres."""
_EXTRA_DEPTH_OF_OLDEST: Final = 0.1
"""Metres by which it grows up to the oldest moment, so that older faces do not mix either."""
_DEPTH_STEP: Final = 0.02
"""Tolerance of depths in metres, since a triangle has a single depth."""
_OCCLUSION_DEPTH: Final = 0.04
"""Difference in depth at which the nearer of two variations mostly covers the other, in metres."""
_VARIATION_STRENGTH: Final = 0.85
_TINT_STRENGTH: Final = 0.75
_LINE: Final = 1.6  # height of a line of text, in letters


def colours_for(count: int) -> tuple[str, ...]:
    """Return the colours of `count` variations; `InputError` if there are too few colours."""
    if count > len(VARIATION_COLOURS):
        raise InputError(
            f"{count} variations cannot be distinguished in one picture",
            remedy=f"Show at most {len(VARIATION_COLOURS)}",
        )
    return VARIATION_COLOURS[:count]


def faded(moments: Sequence[CutOut]) -> CutOut:
    """Return one clip's figure at several moments in one picture, the oldest first and faintest.

    The nearer of two moments covers the other, so that a hand in front of the body leaves a trail.
    At nearly equal depth, the later one is on top, so that faces stay sharp.
    """
    count = len(moments)
    pictures, depths = _stacked(moments)
    ages = np.arange(count)[::-1]
    strengths = _MIN_STRENGTH + (1 - _MIN_STRENGTH) * (1 - ages / count) ** 2
    alphas = pictures[..., 3] * np.where(ages, strengths, 1.0)[:, None, None].astype(np.float32)
    depth_offsets = np.where(ages, _SAME_DEPTH + _EXTRA_DEPTH_OF_OLDEST * ages / count, 0.0)
    far_first = np.argsort(-(depths + depth_offsets[:, None, None]), axis=0, kind="stable")
    colour = np.zeros((*depths.shape[1:], 3), np.float32)
    transparency = np.ones(depths.shape[1:], np.float32)
    for layer in far_first:
        alpha = np.take_along_axis(alphas, layer[None], 0)[0]
        layer_colour = np.take_along_axis(pictures[..., :3], layer[None, ..., None], 0)[0]
        colour = colour * (1 - alpha[..., None]) + layer_colour * alpha[..., None]
        transparency *= 1 - alpha
    opacity = np.maximum(1 - transparency, np.float32(1e-6))[..., None]
    picture = _as_image(colour / opacity, 1 - transparency)
    return CutOut(picture, depths.min(axis=0))


def blended(variations: Sequence[CutOut]) -> CutOut:
    """Blend the figures of several clips into one picture, giving none precedence.

    Parts in which a variation differs have its colour of `VARIATION_COLOURS`; parts that all share
    keep their own colours. If variations overlap, the nearer ones count more.

    Raises
    ------
    InputError
        If there are more variations than colours.
    """
    colours = colours_for(len(variations))
    if len(variations) == 1:
        return variations[0]
    pictures, depths = _stacked(variations)
    nearest = depths.min(axis=0)
    weighted_sum = np.zeros((*nearest.shape, 3), np.float32)
    total = np.zeros_like(nearest)
    transparency = np.ones_like(nearest)
    for picture, depth, colour in zip(pictures, depths, colours, strict=True):
        differences = np.maximum(np.abs(depths - depth) - _DEPTH_STEP, 0)
        shared = (np.exp(-differences / _SAME_DEPTH).sum(axis=0) - 1) / (len(depths) - 1)
        depth_behind = np.maximum(depth - nearest - _DEPTH_STEP, 0)
        weight = picture[..., 3] * np.maximum(np.exp(-depth_behind / _OCCLUSION_DEPTH), 1e-3)
        tint = _TINT_STRENGTH * (1 - shared)[..., None]
        weighted_sum += weight[..., None] * _tinted(picture[..., :3], colour, tint)
        total += weight
        transparency *= 1 - _VARIATION_STRENGTH * picture[..., 3]
    mean = weighted_sum / np.maximum(total, 1e-6)[..., None]
    return CutOut(_as_image(mean, 1 - transparency), nearest)


def draw_overlay(
    picture: Image.Image,
    names: Sequence[str],
    caption: str,
    *,
    clear: bool,
    background: Colour = BACKGROUND,
) -> Plate:
    """Return the overlay as a page: the picture, a legend of the colours, and a caption.

    Parameters
    ----------
    picture : Image
        RGBA, as wide as the page.
    names : sequence of str
        Names of the variations, in the order of their colours; a single one needs no colour.
    caption : str
        The caption, which names the moments.
    clear : bool
        Whether the page is transparent behind the figures.
    background : tuple of int
        Background of the figures if it is not.
    """
    from matplotlib.patches import Rectangle

    line = pixels(LETTERS) * _LINE
    letters = font(pixels(LETTERS))
    lines = (len(names) if len(names) > 1 else 0) + 1
    page = Plate.of(picture.width, round(picture.height + (lines + 0.3) * line), clear=clear)
    ground = Image.new("RGBA", picture.size, (0, 0, 0, 0) if clear else (*background, 255))
    ground.alpha_composite(picture)
    page.add_picture(ground, 0, 0)
    for place, name in enumerate(names if len(names) > 1 else ()):
        middle = picture.height + (place + 0.7) * line
        swatch = page.area(0, middle - line / 4, line / 2, line / 2)
        swatch.add_patch(Rectangle((0, 0), 1, 1, color=VARIATION_COLOURS[place]))
        text = fitted(name, letters, picture.width - line)
        page.write(line * 0.8, middle, text)
    middle = picture.height + (lines - 0.3) * line
    text = fitted(caption, letters, 0.98 * picture.width)
    page.write(0, middle, text)
    return page


def _tinted(colours: Floats32, tint: str, share: Floats32) -> Floats32:
    """Return `colours`, shape (..., 3) in [0, 1], tinted by `share`."""
    light = colours @ np.array([0.299, 0.587, 0.114], np.float32)
    target = np.array(ImageColor.getrgb(tint), np.float32) / 255
    toned = np.clip(target * (0.45 + 1.1 * light[..., None]), 0, 1)
    return np.asarray((1 - share) * colours + share * toned)


def _stacked(figures: Sequence[CutOut]) -> tuple[Floats32, Floats32]:
    """Return all pictures, shape (n, H, W, 4) in [0, 1], and depths, shape (n, H, W)."""
    pictures = np.stack([np.asarray(figure.picture) for figure in figures]).astype(np.float32)
    return pictures / np.float32(255), np.stack([figure.depth for figure in figures])


def _as_image(colour: NDArray[np.floating], alpha: NDArray[np.floating]) -> Image.Image:
    """Return RGBA of `colour`, shape (H, W, 3), and `alpha`, shape (H, W), both in [0, 1]."""
    rgba = np.concatenate([np.clip(colour, 0, 1), alpha[..., None]], axis=-1)
    return Image.fromarray(np.round(rgba * 255).astype(np.uint8), "RGBA")
