"""Any table of the report for a paper, in LaTeX with booktabs."""

from __future__ import annotations

from functools import cache
from itertools import accumulate
from typing import Final

from jinja2 import Environment, PackageLoader, StrictUndefined

from analysis.report import wording
from analysis.report.content import Table

LONGEST: Final = 40
"""Rows up to which a table floats; a longer one breaks over pages."""

_LATEX: Final = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "[": "{[}",
        "]": "{]}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "|": r"\textbar{}",
        '"': r"\textquotedbl{}",
        "'": r"\textquotesingle{}",
        "`": r"\textasciigrave{}",
        "\n": " ",
        "\r": " ",
        "\t": " ",
        "–": "--",
        "—": "---",
        "“": "``",
        "”": "''",
        "‘": "`",
        "’": "'",
        "…": r"\dots{}",
        wording.NO_BREAK: "~",
        "\u202f": r"\,",
        "−": "$-$",
        "±": r"$\pm$",
        "×": r"$\times$",
        "·": r"$\cdot$",
        "≥": r"$\geq$",
        "≤": r"$\leq$",
        "≈": r"$\approx$",
        "′": "$'$",
        "°": r"$^\circ$",
        "²": "$^2$",
        "↑": r"$\uparrow$",
        "↓": r"$\downarrow$",
        "→": r"$\rightarrow$",
        "←": r"$\leftarrow$",
        "∞": r"$\infty$",
        "√": r"$\surd$",
        "†": r"\dag{}",
        "‡": r"\ddag{}",
        "✓": r"$\surd$",
        "✗": r"$\times$",
        "α": r"$\alpha$",
        "β": r"$\beta$",
        "δ": r"$\delta$",
        "κ": r"$\kappa$",
        "λ": r"$\lambda$",
        "μ": r"$\mu$",
        "ν": r"$\nu$",
        "ρ": r"$\rho$",
        "σ": r"$\sigma$",
        "τ": r"$\tau$",
        "χ": r"$\chi$",
        "Δ": r"$\Delta$",
        "Σ": r"$\Sigma$",
    }
)


def booktabs(table: Table, *, remark: str = "") -> str:
    """Return a table as a LaTeX file that compiles as it is, whatever its cells say.

    Parameters
    ----------
    table : Table
        Its caption and its notes go along; the best cells become bold, the second best underlined.
    remark : str, optional
        Put before the caption, such as that no person answered.
    """
    is_long = len(table.rows) > LONGEST
    ends = list(accumulate(span for _, span in table.groups))
    body = (
        _environment()
        .get_template("table.tex")
        .render(
            table=table,
            is_long=is_long,
            columns="l" * table.text_columns + "r" * (len(table.header) - table.text_columns),
            caption=f"{remark} {table.caption}".strip(),
            rules=[
                (end - span + 1, end)
                for (label, span), end in zip(table.groups, ends, strict=True)
                if label
            ],
        )
    )
    return "\n".join([*_needs(body, long=is_long), body])


@cache
def _environment() -> Environment:
    environment = Environment(  # noqa: S701 - what is written is LaTeX, escaped by its own filter
        loader=PackageLoader("analysis.report", "templates"),
        undefined=StrictUndefined,
        block_start_string="<%",
        block_end_string="%>",
        variable_start_string="<<",
        variable_end_string=">>",
        comment_start_string="<#",
        comment_end_string="#>",
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["latex"] = as_latex
    return environment


def as_latex(text: str) -> str:
    """Return text as LaTeX prints it, none of its signs taken for a command."""
    return text.translate(_LATEX)


def _needs(body: str, *, long: bool) -> list[str]:
    packages = "booktabs,longtable" if long else "booktabs,graphicx"
    lines = [rf"% Needs \usepackage{{{packages}}} and \usepackage[T1]{{fontenc}}."]
    lines += (
        [r"% Needs \usepackage{textcomp} before LaTeX 2020."] if "textquotesingle" in body else []
    )
    if any(ord(sign) > 0x17F for sign in body):
        lines.append(
            "% Names hold letters that LuaLaTeX or XeLaTeX print with a font that has them."
        )
    return lines
