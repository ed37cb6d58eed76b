"""The report's main table for a paper, in LaTeX with booktabs."""

from __future__ import annotations

from typing import Final

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.answer import figure_order
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs

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
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "–": "--",
        wording.NO_BREAK: "~",
        "−": "$-$",
    }
)


def latex_table(inputs: ReportInputs, findings: Findings) -> str:
    """Return the main table, AMUSE's Table A.5 sums with win shares, for LaTeX's booktabs."""
    questions = figure_order(inputs)
    by_place = {(p.other, p.question): p for p in findings.preferences}
    columns = "l" + "rrl" * len(questions)
    heads = " & ".join(
        rf"\multicolumn{{3}}{{c}}{{{_latex(wording.heading(q))}}}" for q in questions
    )
    rules = "".join(rf"\cmidrule(lr){{{2 + 3 * k}-{4 + 3 * k}}}" for k in range(len(questions)))
    lines = [
        rf"% Needs \usepackage{{booktabs}}. Origin of the answers: {inputs.origin}.",
        r"\begin{table}",
        r"  \centering",
        rf"  \caption{{{_latex(_caption(inputs))}}}",
        rf"  \begin{{tabular}}{{{columns}}}",
        r"    \toprule",
        rf"    & {heads} \\",
        f"    {rules}",
        "    Condition" + " & Ours & Others & Win share" * len(questions) + r" \\",
        r"    \midrule",
    ]
    for other in dict.fromkeys(p.other for p in findings.preferences):
        row = [_latex(wording.name(other))]
        for question in questions:
            found = by_place[other, question]
            counts = found.counts
            row += [
                _bold(wording.percent(counts.ours), counts.ours > counts.others),
                _bold(wording.percent(counts.others), counts.others > counts.ours),
                _latex(wording.estimate(found.win_share)),
            ]
        lines.append(f"    {' & '.join(row)} \\\\")
    return "\n".join([*lines, r"    \bottomrule", r"  \end{tabular}", r"\end{table}", ""])


def _caption(inputs: ReportInputs) -> str:
    start = "Rehearsal with simulated raters, no person answered. " * (inputs.origin == "rehearsal")
    reference = wording.name(inputs.reference)
    return (
        f"{start}Ours: clear and slight preferences for {reference}, others: for the condition of "
        "the row, in % of all answers. Win share: preferences for "
        f"{reference} plus half the ties, with its {LEVEL:.0%} interval clustered by participant "
        "and segment."
    )


def _latex(text: str) -> str:
    return text.translate(_LATEX)


def _bold(text: str, best: bool) -> str:
    return rf"\textbf{{{_latex(text)}}}" if best else _latex(text)
