"""The section that holds a rehearsal's estimates against what its raters were given."""

from __future__ import annotations

from analysis.preferences.clustered import LEVEL
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
        covered = mean.low <= known.share <= mean.high
        inside += covered
        rows.append(
            cells(
                wording.name(p.question),
                wording.name(p.other),
                wording.share(known.share),
                wording.estimate(mean),
                "no interval" if mean.reason else "inside" if covered else "outside",
                wording.share(known.on_these_segments),
            )
        )
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=(
            f"Simulated raters prefer by rule, so the true win share is known. "
            f"{inside} of {len(rows)} intervals contain it. In the long run about {LEVEL:.0%} "
            f"should, so that one or more of {len(rows)} may miss it in up to "
            f"{100 * (1 - LEVEL ** len(rows)):.0f} of 100 rehearsals.",
        ),
        tables=(
            Table(
                caption=f"True win share of {wording.name(inputs.reference)} among the simulated "
                "raters, and its estimate after exclusions. The interval speaks of all segments "
                "such as these; which ones were drawn moves the estimate towards the last column.",
                header=(
                    "question",
                    "against",
                    "truth",
                    "estimate",
                    "truth is",
                    "truth for these segments",
                ),
                rows=tuple(rows),
                text_columns=2,
                data="preferences.csv",
            ),
        ),
    )
