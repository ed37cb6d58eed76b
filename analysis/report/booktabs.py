"""Any table of the report for a paper, in LaTeX with booktabs."""

from __future__ import annotations

from typing import Final

from analysis.report import wording
from analysis.report.content import Cell, Table

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
    long = len(table.rows) > LONGEST
    columns = "l" * table.text_columns + "r" * (len(table.header) - table.text_columns)
    caption = rf"\caption{{{as_latex(f'{remark} {table.caption}'.strip())}}}"
    head = [
        *_groups(table),
        f"{' & '.join(map(as_latex, table.header))} \\\\",
    ]
    rows = [f"{' & '.join(map(_cell, row))} \\\\" for row in table.rows]
    notes = [rf"{{\footnotesize {as_latex(note)}\par}}" for note in table.notes]
    if long:
        body = [
            r"\begingroup\footnotesize\setlength{\tabcolsep}{3pt}",
            rf"\begin{{longtable}}{{{columns}}}",
            rf"{caption} \\",
            r"\toprule",
            *head,
            r"\midrule",
            r"\endhead",
            *rows,
            r"\bottomrule",
            r"\end{longtable}",
            *notes,
            r"\endgroup",
        ]
    else:
        body = [
            r"\begin{table}",
            r"\centering",
            caption,
            # A table that is too wide for its column becomes smaller; no other one changes.
            r"\resizebox{\ifdim\width>\linewidth\linewidth\else\width\fi}{!}{%",
            rf"\begin{{tabular}}{{{columns}}}",
            r"\toprule",
            *head,
            r"\midrule",
            *rows,
            r"\bottomrule",
            r"\end{tabular}}",
            *([r"\par\smallskip", *notes] if notes else []),
            r"\end{table}",
        ]
    return "\n".join([*_needs("\n".join(body), long=long), *body, ""])


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


def _groups(table: Table) -> list[str]:
    """Return the headings over several columns, and the rules under them."""
    if not table.groups:
        return []
    heads, rules, column = [], [], 1
    for label, span in table.groups:
        if not label:
            heads.append(" & ".join([""] * span))
        else:
            heads.append(rf"\multicolumn{{{span}}}{{c}}{{{as_latex(label)}}}")
            rules.append(rf"\cmidrule(lr){{{column}-{column + span - 1}}}")
        column += span
    return [f"{' & '.join(heads)} \\\\", "".join(rules)]


def _cell(cell: Cell) -> str:
    text = as_latex(cell.text)
    if cell.best:
        return rf"\textbf{{{text}}}"
    return rf"\underline{{{text}}}" if cell.second else text
