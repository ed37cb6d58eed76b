"""The section that holds a rehearsal's estimates against what its raters were given."""

from __future__ import annotations

from analysis.report import wording
from analysis.report.answer import figure_order
from analysis.report.content import Section, Table, cells
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs


def truth_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return how a rehearsal's estimates compare with what its raters were given."""
    truth = inputs.truth or {}
    rows, inside = [], 0
    order = figure_order(inputs)
    for p in sorted(findings.preferences, key=lambda p: order.index(p.question)):
        known = truth.get((p.comparison, p.question))
        if known is None:
            continue
        mean = p.win_share
        covered = mean.low <= known <= mean.high
        inside += covered
        rows.append(
            cells(
                wording.name(p.question),
                wording.name(p.other),
                wording.share(known),
                wording.estimate(mean),
                "no interval" if mean.reason else "inside" if covered else "outside",
            )
        )
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=(
            f"Simulated raters prefer by rule, so the true win share is known. "
            f"{inside} of {len(rows)} intervals contain it; in the long run 95% do.",
        ),
        tables=(
            Table(
                caption=f"True win share of {wording.name(inputs.reference)} among the simulated "
                "raters, and its estimate after exclusions.",
                header=("question", "against", "truth", "estimate", "truth is"),
                rows=tuple(rows),
                text_columns=2,
                data="preferences.csv",
            ),
        ),
    )
