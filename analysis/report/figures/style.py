"""The style of figures, and figures as files and inline SVG: real text, reproducible bytes."""

import io
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from textwrap import wrap
from typing import Any, Final, NamedTuple

import matplotlib as mpl
import numpy as np
from markupsafe import Markup, escape
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, get_font_names
from matplotlib.textpath import TextToPath

from analysis.report.content import FigureText, Picture

INK: Final = "#22262b"
SOFT: Final = "#5f6670"
LINE: Final = "#c7ccd2"
PAPER: Final = "#fdfdfe"
MARK: Final = "#8a3500"

PAGE_COLOURS: Final = {
    INK: "var(--ink, #22262b)",
    SOFT: "var(--soft, #5f6670)",
    LINE: "var(--line, #c7ccd2)",
    PAPER: "var(--paper, #fdfdfe)",
    MARK: "var(--mark, #8a3500)",
}
"""Replacements for colours in inline figures, which suit a light and a dark page."""

BLUE: Final = "#0072b2"
SKY: Final = "#56b4e9"
NEUTRAL: Final = "#d9dce0"
ORANGE: Final = "#e69f00"
VERMILLION: Final = "#d55e00"

DIVERGING: Final = (BLUE, SKY, NEUTRAL, ORANGE, VERMILLION)
"""Okabe and Ito's blue and vermillion pairs with grey between them."""

SERIES: Final = (
    *(BLUE, VERMILLION, "#009e73", "#cc79a7", ORANGE, SKY),
    *("#7a5195", "#8c6d31", "#6b7785", "#b2182b", "#1b7837", "#40648f"),
)
"""Colours of twelve conditions, which also differ in their markers."""

_MARKERS: Final = "osD^vP<>Xhp*"

_DIVERGING_MAP: Final = LinearSegmentedColormap.from_list("diverging", DIVERGING)
_SEQUENTIAL_MAP: Final = LinearSegmentedColormap.from_list(
    "sequential", ("#e4edf4", "#9fcbe6", "#4a9fd0", "#0072b2", "#084b78")
)

TITLE_SIZE: Final = 9.0
LABEL_SIZE: Final = 8.0
SMALL_SIZE: Final = 7.0

WIDTH: Final = 7.2
"""Width of every figure in inches, which fits between the margins of A4."""

POINTS_PER_INCH: Final = 72.0

FORMATS: Final[Mapping[str, dict[str, None]]] = {
    "pdf": {"CreationDate": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}
"""File extensions of figures, and the metadata omitted from each."""

_FALLBACK_FONTS: Final = (
    *("Noto Sans CJK JP", "Noto Sans CJK SC", "IPAexGothic", "Noto Sans", "Unifont"),
)
"""Fonts for letters that DejaVu Sans lacks, if they are installed."""

STYLE: Final[dict[Any, Any]] = {
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
    "font.family": ["DejaVu Sans", *(n for n in _FALLBACK_FONTS if n in get_font_names())],
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


def series_style(index: int) -> tuple[str, str]:
    """Return the colour and the marker of one of several conditions or questions."""
    return SERIES[index % len(SERIES)], _MARKERS[index % len(_MARKERS)]


def diverging_colour(share: float) -> str:
    """Return the colour of a share, from 0 (one side) over .5 (neither) to 1 (the other side)."""
    return to_hex(_DIVERGING_MAP(float(np.clip(share, 0, 1))))


def scale_colours(count: int) -> tuple[str, ...]:
    """Return the colours of a scale's points, worst first."""
    if count == len(DIVERGING):
        return DIVERGING[::-1]
    return tuple(diverging_colour(1 - k / max(count - 1, 1)) for k in range(count))


def place_colours(count: int) -> tuple[str, ...]:
    """Return the colours of the places of a ranking, the first place darkest."""
    return tuple(to_hex(_SEQUENTIAL_MAP(1 - k / max(count - 1, 1))) for k in range(count))


def text_colour(background: str) -> str:
    """Return the colour of words on a background: near white if it is dark, else near black."""
    red, green, blue = (
        channel / 12.92 if channel <= 0.04045 else float(((channel + 0.055) / 1.055) ** 2.4)
        for channel in to_rgb(background)
    )
    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    return "#fefefe" if luminance < 0.25 else "#101316"


def fit_text(text: str, inches: float, *, size: float, lines: int = 1, bold: bool = False) -> str:
    """Break text into lines no wider than `inches`, and shorten it with '…' if it needs more.

    Parameters
    ----------
    text : str
        Words.
    inches : float
        Width of a line.
    size : float
        Font size, in points.
    lines : int
        The most lines.
    bold : bool
        Whether the words are bold.
    """
    width = inches * POINTS_PER_INCH / size
    fitting: list[str] = []
    for characters in range(len(text), 0, -1):
        fitting = wrap(text, characters)
        if len(fitting) > lines:
            shortened = " ".join(fitting[lines - 1 :])[: characters - 1].rstrip()
            fitting[lines - 1 :] = [f"{shortened}…"]
        if all(sum(_width(c, bold) for c in line) <= width for line in fitting):
            break
    return "\n".join(fitting)


@cache
def _width(character: str, bold: bool) -> float:
    """Return the width of a character as a multiple of the font size."""
    font = FontProperties(family="DejaVu Sans", size=100, weight="bold" if bold else "normal")
    with missing_glyphs():
        width, _, _ = TextToPath().get_text_width_height_descent(character, font, ismath=False)
    return float(width) / 100


@contextmanager
def missing_glyphs() -> Iterator[None]:
    """Draw letters that all fonts lack as boxes, without a warning; browsers have more fonts."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        yield


@dataclass(frozen=True, kw_only=True)
class Scale:
    """The horizontal axis of a panel.

    Attributes
    ----------
    limits : (float, float) or None
        The range; None to fit the panels of a sheet.
    ticks : mapping of float to str, or None
        Positions and labels of ticks; None for round numbers.
    label : str
        The axis label.
    line : float or None
        Position of a line across all rows.
    """

    limits: tuple[float, float] | None = None
    ticks: Mapping[float, str] | None = None
    label: str = ""
    line: float | None = None

    def apply(self, axes: Axes, inches: float) -> None:
        """Apply the scale to axes of a width in inches."""
        size = SMALL_SIZE + 0.5
        if self.limits is not None:
            axes.set_xlim(*self.limits)
        if self.ticks is None:
            axes.locator_params(axis="x", nbins=4, steps=(1, 2, 5, 10))
        else:
            axes.set_xticks(list(self.ticks), labels=list(self.ticks.values()))
        axes.tick_params(axis="x", labelsize=SMALL_SIZE, pad=1.5)
        label = fit_text(self.label, inches, size=size, lines=2)
        axes.set_xlabel(label, fontsize=size, labelpad=2.0)
        if self.line is not None:
            axes.axvline(self.line, color=SOFT, linewidth=0.7, zorder=0)


def annotate_row(axes: Axes, row: int, words: str, below: str, *, bold: bool = False) -> None:
    """Write words, and smaller ones below them, to the right of a panel's row."""
    height = 4.4 if below else 0.0
    size, weight = (8.5, "bold") if bold else (8.0, "normal")
    for text, offset, font in (
        (words, height, {"fontsize": size, "fontweight": weight}),
        (below, -5.2, {"fontsize": SMALL_SIZE - 0.5}),
    ):
        if text:
            axes.annotate(
                text,
                (1, row),
                xycoords=axes.get_yaxis_transform(),
                xytext=(8, offset),
                textcoords="offset points",
                va="center",
                annotation_clip=False,
                **font,
            )


_ID: Final = re.compile(r'(id="|href="#|url\(#)')
_COLOUR: Final = re.compile("|".join(PAGE_COLOURS))


class Drawing(NamedTuple):
    """A figure, and the same with its numbers in words, for readers who cannot see it."""

    figure: Figure
    description: str


def make_picture(wide: Drawing, narrow: Drawing, text: FigureText) -> Picture:
    """Return a figure for the page and for the folder of figures.

    Parameters
    ----------
    wide, narrow : Drawing
        For the page and the files, and for the page on a narrow screen; drawn under `STYLE`.
    text : FigureText
        The text around it.
    """
    return Picture(
        svg=inline_svg(wide, text.name, text.title, "wide")
        + inline_svg(narrow, f"{text.name}-narrow", text.title, "narrow"),
        caption=text.caption,
        data=text.data,
        name=text.name,
        figure=wide.figure,
    )


def inline_svg(drawing: Drawing, name: str, title: str, css_class: str) -> Markup:
    """Return a drawing as an ``svg`` element for an HTML page; its ids begin with `name`."""
    stream = io.StringIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}), missing_glyphs():
        drawing.figure.savefig(
            stream,
            format="svg",
            transparent=True,
            metadata={"Date": None, "Creator": None, "Format": None, "Type": None},
        )
    svg = stream.getvalue()
    svg = svg[svg.index("<svg") :].strip()
    svg = _ID.sub(lambda match: f"{match[1]}{name}-", svg)
    svg = _COLOUR.sub(lambda match: PAGE_COLOURS[match[0]], svg)
    end_of_tag = svg.index(">") + 1
    words = (
        f'<title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-desc">{escape(drawing.description)}</desc>'
    )
    svg = svg[:end_of_tag] + words + svg[end_of_tag:]
    attributes = (
        f'class="{css_class}" role="img" '
        f'aria-labelledby="{name}-title" aria-describedby="{name}-desc"'
    )
    return Markup(svg.replace("<svg", f"<svg {attributes}", 1))  # noqa: S704 - all words are escaped


def as_file(figure: Figure, extension: str) -> bytes:
    """Return a figure as a file of `FORMATS`, without a date; PNG has 200 dots per inch."""
    stream = io.BytesIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": extension}), missing_glyphs():
        figure.savefig(
            stream,
            format=extension,
            dpi=200 if extension == "png" else "figure",
            metadata=FORMATS[extension],
        )
    return stream.getvalue()
