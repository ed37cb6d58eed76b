"""Matplotlib figures as inline SVG: real text, ids of their own, the same bytes every time."""

from __future__ import annotations

import io
import re
from collections.abc import Mapping
from typing import Any, Final

import matplotlib as mpl
from markupsafe import Markup, escape
from matplotlib.figure import Figure

WIDTH: Final = 10.0
"""Width of every figure in inches, at which text stays readable on A4."""

STYLE: Final[dict[Any, Any]] = {
    "svg.fonttype": "none",
    "font.family": "DejaVu Sans",
    "font.size": 10.0,
    "text.parse_math": False,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.spines.left": False,
    "axes.edgecolor": "#5f6670",
    "axes.labelcolor": "#22262b",
    "text.color": "#22262b",
    "xtick.color": "#5f6670",
    "xtick.labelcolor": "#22262b",
    "ytick.color": "#5f6670",
    "ytick.labelcolor": "#22262b",
}
"""Settings under which the report's figures are drawn."""

_ID: Final = re.compile(r'(id="|href="#|url\(#)')


def inline_svg(
    figure: Figure, *, name: str, alt: str, hints: Mapping[str, str] | None = None
) -> Markup:
    """Return `figure` as an ``svg`` element for the body of an HTML page.

    Parameters
    ----------
    figure : Figure
        Drawn under `STYLE`.
    name : str
        Prefix that keeps the ids of several figures on one page apart.
    alt : str
        What the figure shows, for those who cannot see it.
    hints : mapping of str to str, optional
        Text shown on hover, by the gid of the artist it belongs to.
    """
    stream = io.StringIO()
    with mpl.rc_context({**STYLE, "svg.hashsalt": name}):
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
    return Markup(  # noqa: S704 - matplotlib escapes its text, hints are escaped above
        body.replace("<svg", f'<svg role="img" aria-label="{escape(alt)}"', 1)
    )
