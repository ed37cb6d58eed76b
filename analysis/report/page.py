"""Turning findings into a page, apart from how the page looks."""

from __future__ import annotations

from analysis.preferences.clustered import LEVEL
from analysis.report import wording
from analysis.report.answer import answer, figure_order, flow_line
from analysis.report.content import Page, Picture
from analysis.report.emotion_section import emotion_section
from analysis.report.findings import Findings
from analysis.report.flow_section import flow_section
from analysis.report.inputs import ReportInputs
from analysis.report.metric_section import metrics_section
from analysis.report.preference_figure import preference_figure
from analysis.report.preference_sections import counts_section, win_share_section
from analysis.report.scope_sections import generality_section, methods_section
from analysis.report.truth_section import truth_section

_MARKS = {
    "participants": ("", ""),
    "rehearsal": ("Rehearsal: simulated raters, no person answered", "rehearsal"),
    "none": ("No participants yet: metrics only", "no participants yet"),
}


def build_page(inputs: ReportInputs, findings: Findings) -> Page:
    """Return everything that the template lays out."""
    mark, short = _MARKS[inputs.origin]
    analysed = not findings.exclusion.analysed.empty
    sections = []
    if inputs.origin != "none":
        sections += [win_share_section(inputs, findings)]
        sections += [counts_section(inputs, findings)] if analysed else []
        sections += [flow_section(inputs, findings)]
        sections += [emotion_section(inputs, findings, mark)] if analysed else []
    sections.append(metrics_section(inputs, findings))
    if inputs.origin == "rehearsal" and inputs.truth:
        sections.append(truth_section(inputs, findings))
    sections += [generality_section(inputs, findings), methods_section(inputs, findings)]
    return Page(
        title=inputs.title,
        mark=mark,
        mark_short=short,
        answer=answer(inputs, findings),
        picture=_picture(inputs, findings, mark) if analysed else None,
        flow=flow_line(inputs, findings),
        sections=tuple(sections),
    )


def _picture(inputs: ReportInputs, findings: Findings, mark: str) -> Picture:
    reference = wording.name(inputs.reference)
    return Picture(
        svg=preference_figure(findings.preferences, figure_order(inputs), mark=mark),
        caption=f"Answers comparing {reference} with each other condition, in %, around “no "
        f"difference”, after exclusions; n analysed. Right: win share of {reference} (wins plus "
        f"half the ties) with its {LEVEL:.0%} interval, clustered by participant and segment; "
        ".5 means that neither is preferred.",
        data="counts.csv",
    )
