"""Matplotlib figures as files and as inline SVG: real text, ids of their own, equal bytes."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final

import matplotlib as mpl
from markupsafe import Markup, escape
from matplotlib.figure import Figure

from analysis.report.content import About, Picture
from analysis.report.figures.style import FOLLOWS_THE_PAGE, STYLE

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
