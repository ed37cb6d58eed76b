"""How figures look, and figures as files and as inline SVG: real text, the same bytes each time."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from textwrap import wrap
from typing import Any, Final

import matplotlib as mpl
import numpy as np
from markupsafe import Markup, escape
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap, to_hex, to_rgb
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties, get_font_names
from matplotlib.textpath import TextToPath

from analysis.report.content import About, Picture

POINTS: Final = 72.0
"""Points in an inch."""


def fitted(text: str, inches: float, *, size: float, lines: int = 1, bold: bool = False) -> str:
    """Break text into at most `lines` that are no wider than `inches`; '…' stands for the rest.

    Parameters
    ----------
    text : str
        Words.
    inches : float
        Room.
    size : float
        Of the font, in points.
    lines : int
        How many at most.
    bold : bool
        Whether the words will be bold.
    """
    room = inches * POINTS / size
    found: list[str] = []
    for signs in range(len(text), 0, -1):
        found = wrap(text, signs)
        if len(found) > lines:
            rest = " ".join(found[lines - 1 :])[: signs - 1].rstrip()
            found[lines - 1 :] = [f"{rest}…"]
        if all(_wide(line, bold) <= room for line in found):
            break
    return "\n".join(found)


def _wide(text: str, bold: bool) -> float:
    """Return the width of text in sizes of its font."""
    return sum(_sign_width(sign, bold) for sign in text)


@cache
def _sign_width(sign: str, bold: bool) -> float:
    font = FontProperties(family="DejaVu Sans", size=100, weight="bold" if bold else "normal")
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        width, _, _ = TextToPath().get_text_width_height_descent(sign, font, ismath=False)
    return float(width) / 100


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


TITLE_SIZE: Final = 9.0


LABEL_SIZE: Final = 8.0


SMALL_SIZE: Final = 7.0


@dataclass(frozen=True, kw_only=True)
class Scale:
    """The axis of a panel.

    Attributes
    ----------
    limits : (float, float) or None
        How far it goes; None for as far as the panels of a sheet need.
    ticks : mapping of float to str
        Where its ticks are, and what they are called; {} for round numbers.
    label : str
        What it shows.
    ends : (str, str)
        What it shows towards its two ends, in place of `label`; ('', '') for neither.
    line : float or None
        Where a line goes through all rows.
    """

    limits: tuple[float, float] | None = None
    ticks: Mapping[float, str] | None = None
    label: str = ""
    ends: tuple[str, str] = ("", "")
    line: float | None = None

    def dress(self, axes: Axes, inches: float) -> None:
        """Give axes of so many inches their scale."""
        if self.limits is not None:
            axes.set_xlim(*self.limits)
        if self.ticks is None:
            axes.locator_params(axis="x", nbins=4, steps=(1, 2, 5, 10))
        else:
            axes.set_xticks(list(self.ticks), labels=list(self.ticks.values()))
        axes.tick_params(axis="x", labelsize=SMALL_SIZE, pad=1.5)
        axes.set_xlabel(self.label, fontsize=SMALL_SIZE + 0.5, labelpad=2.0)
        for where, end in zip((0.0, 1.0), self.ends, strict=True):
            if not end:
                continue
            words = fitted(end, inches / 2 - 0.2, size=SMALL_SIZE + 0.5, lines=2)
            axes.annotate(
                f"{words} →" if where else f"← {words}",
                (where, 0),
                xycoords="axes fraction",
                xytext=(0, -13),
                textcoords="offset points",
                ha="right" if where else "left",
                va="top",
                fontsize=SMALL_SIZE + 0.5,
            )
        if self.line is not None:
            axes.axvline(self.line, color=SOFT, linewidth=0.7, zorder=0)


def write_beside(axes: Axes, row: int, words: str, below: str, *, bold: bool = False) -> None:
    """Write words, and smaller ones under them, at the right of a row of a panel."""
    high = 4.4 if below else 0.0
    size, weight = (8.5, "bold") if bold else (8.0, "normal")
    for text, height, style in (
        (words, high, {"fontsize": size, "fontweight": weight}),
        (below, -5.2, {"fontsize": SMALL_SIZE - 0.5}),
    ):
        if text:
            axes.annotate(
                text,
                (1, row),
                xycoords=axes.get_yaxis_transform(),
                xytext=(8, height),
                textcoords="offset points",
                va="center",
                annotation_clip=False,
                **style,
            )


WIDTH: Final = 7.2
"""Width of every figure in inches: what A4 holds between its margins."""

FORMATS: Final[Mapping[str, dict[str, None]]] = {
    "pdf": {"CreationDate": None, "Producer": None},
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
}
"""How figures are written, by the ending of the file, and what the file leaves out."""

_DOTS: Final = 200

_ID: Final = re.compile(r'(id="|href="#|url\(#)')
_COLOUR: Final = re.compile("|".join(FOLLOWS_THE_PAGE))


@dataclass(frozen=True, kw_only=True, eq=False)
class Drawing:
    """A figure, and what is shown on hover by the gid of the artist that it belongs to."""

    figure: Figure
    hints: Mapping[str, str]


def picture(wide: Drawing, about: About, told: str, *, narrow: Drawing | None = None) -> Picture:
    """Return a figure for the page and for the folder of figures.

    Parameters
    ----------
    wide : Drawing
        Drawn under `analysis.report.figures.style.STYLE`.
    about : About
        What stands around it.
    told : str
        What it shows, with its numbers, for those who cannot see it.
    narrow : Drawing, optional
        The same once more, for the page on a narrow screen.
    """
    svg = inline_svg(wide.figure, name=about.name, title=about.title, alt=told, hints=wide.hints)
    if narrow is not None:
        small = inline_svg(
            narrow.figure,
            name=f"{about.name}-narrow",
            title=about.title,
            alt=told,
            hints=narrow.hints,
        )
        svg = _of_class(svg, "wide") + _of_class(small, "narrow")
    return Picture(
        svg=svg, caption=about.caption, data=about.data, name=about.name, figure=wide.figure
    )


def inline_svg(
    figure: Figure,
    *,
    name: str,
    title: str,
    alt: str,
    hints: Mapping[str, str] | None = None,
) -> Markup:
    """Return `figure` as an ``svg`` element for the body of an HTML page.

    Its ids begin with `name`.
    """
    stream = io.StringIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}), _any_letters():
        figure.savefig(
            stream,
            format="svg",
            transparent=True,
            metadata={"Date": None, "Creator": None, "Format": None, "Type": None},
        )
    text = stream.getvalue()
    body = text[text.index("<svg") :].strip()
    for gid, hint in (hints or {}).items():
        group = f'<g id="{gid}">'
        body = body.replace(group, f"{group}<title>{escape(hint)}</title>", 1)
    body = _ID.sub(lambda found: f"{found.group(1)}{name}-", body)
    body = _COLOUR.sub(lambda found: FOLLOWS_THE_PAGE[found.group()], body)
    return Markup(_named(body, name, title, alt))  # noqa: S704 - all words are escaped


def as_file(figure: Figure, ending: str) -> bytes:
    """Return `figure` as a file of `FORMATS`, without a date; PNG has 200 dots an inch."""
    stream = io.BytesIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": ending}), _any_letters():
        figure.savefig(
            stream,
            format=ending,
            dpi=_DOTS if ending == "png" else "figure",
            metadata=FORMATS[ending],
        )
    return stream.getvalue()


def _of_class(svg: Markup, name: str) -> Markup:
    return Markup(str(svg).replace("<svg", f'<svg class="{name}"', 1))  # noqa: S704 - as it was


@contextmanager
def _any_letters() -> Iterator[None]:
    """Draw letters that no installed font has as boxes; on a page the browser has its own fonts."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph .* missing from font")
        yield


def _named(body: str, name: str, title: str, alt: str) -> str:
    labels = f'role="img" aria-labelledby="{name}-title" aria-describedby="{name}-desc"'
    start = body.index(">", body.index("<svg")) + 1
    words = (
        f'<title id="{name}-title">{escape(title)}</title>'
        f'<desc id="{name}-desc">{escape(alt)}</desc>'
    )
    return (body[:start] + words + body[start:]).replace("<svg", f"<svg {labels}", 1)
