"""The colours of figures: those of words and lines follow the page, those of data stay."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, to_hex, to_rgb
from matplotlib.font_manager import get_font_names

INK: Final = "#22262b"
SOFT: Final = "#5f6670"
LINE: Final = "#c7ccd2"
PAPER: Final = "#fdfdfe"
MARK: Final = "#8a3500"

FOLLOWS_THE_PAGE: Final = {
    INK: "var(--ink, #22262b)",
    SOFT: "var(--soft, #5f6670)",
    LINE: "var(--line, #c7ccd2)",
    PAPER: "var(--paper, #fdfdfe)",
    MARK: "var(--mark, #8a3500)",
}
"""What an inline figure writes in place of a colour, so that it suits a light and a dark page."""

BLUE: Final = "#0072b2"
SKY: Final = "#56b4e9"
NEUTRAL: Final = "#d9dce0"
ORANGE: Final = "#e69f00"
VERMILLION: Final = "#d55e00"

FIVE: Final = (BLUE, SKY, NEUTRAL, ORANGE, VERMILLION)
"""Okabe & Ito's blue and vermillion pairs with grey between: from one side to the other."""

SERIES: Final = (
    *(BLUE, VERMILLION, "#009e73", "#cc79a7", ORANGE, SKY),
    *("#7a5195", "#8c6d31", "#6b7785", "#b2182b", "#1b7837", "#40648f"),
)
"""One colour for each of twelve conditions; marks tell them apart as well."""

_MARKERS: Final = "osD^vP<>Xhp*"

_TO_SIDES: Final = LinearSegmentedColormap.from_list("sides", FIVE)
_DEEPENING: Final = LinearSegmentedColormap.from_list(
    "deepening", ("#e4edf4", "#9fcbe6", "#4a9fd0", "#0072b2", "#084b78")
)


def sign_of(place: int) -> tuple[str, str]:
    """Return the colour and the marker of one of several conditions or questions."""
    return SERIES[place % len(SERIES)], _MARKERS[place % len(_MARKERS)]


def between_sides(place: float) -> str:
    """Return the colour at `place`, from 0 (one side) over .5 (neither) to 1 (the other)."""
    return to_hex(_TO_SIDES(float(np.clip(place, 0, 1))))


def scale_colours(count: int) -> tuple[str, ...]:
    """Return the colours of a scale's points, worst first."""
    if count == len(FIVE):
        return FIVE[::-1]
    return tuple(between_sides(1 - k / max(count - 1, 1)) for k in range(count))


def place_colours(count: int) -> tuple[str, ...]:
    """Return the colours of the places of a ranking, the first place darkest."""
    return tuple(to_hex(_DEEPENING(1 - k / max(count - 1, 1))) for k in range(count))


def on(colour: str) -> str:
    """Return the colour of words on a coloured part: near white on dark ones, else near black."""
    red, green, blue = (_linear(part) for part in to_rgb(colour))
    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return "#fefefe" if luminance < 0.25 else "#101316"


def _linear(part: float) -> float:
    return part / 12.92 if part <= 0.04045 else float(((part + 0.055) / 1.055) ** 2.4)


_FURTHER: Final = ("Noto Sans CJK JP", "Noto Sans CJK SC", "IPAexGothic", "Noto Sans", "Unifont")
"""Fonts that files use, where they are installed, for letters that DejaVu Sans does not have."""

STYLE: Final[dict[Any, Any]] = {
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "font.family": ["DejaVu Sans", *(name for name in _FURTHER if name in get_font_names())],
    "font.size": 8.0,
    "text.parse_math": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.spines.left": False,
    "axes.linewidth": 0.6,
    "axes.edgecolor": SOFT,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": SOFT,
    "xtick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.color": SOFT,
    "ytick.labelcolor": INK,
}
"""Settings under which figures are drawn."""
