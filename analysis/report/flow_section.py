"""The section on participants: who is analysed, who is left out, and why."""

from __future__ import annotations

from analysis.exclusions.study_sessions import Flow
from analysis.report import wording
from analysis.report.answer import people
from analysis.report.content import Section, Table, cells
from analysis.report.findings import Findings
from analysis.report.inputs import ReportInputs


def flow_section(inputs: ReportInputs, findings: Findings) -> Section:
    """Return who took part, who was left out, and why."""
    exclusion = findings.exclusion
    others = {p.comparison: wording.name(p.other) for p in findings.preferences}
    header = ["comparison with"]
    if inputs.study_sessions is not None:
        header.append("started")
    header += ["answered", *(f"− {outcome.description}" for outcome in exclusion.outcomes)]
    flows = {flow.comparison: flow for flow in exclusion.flow}
    rows = []
    for comparison, other in others.items():
        flow = flows.get(comparison) or Flow(
            comparison=comparison, answered=0, removed=(0,) * len(exclusion.outcomes), analysed=0
        )
        row = [other]
        if inputs.study_sessions is not None:
            row.append(str(inputs.study_sessions.get(comparison, flow.answered)))
        row += [str(flow.answered), *map(str, flow.removed), str(flow.analysed)]
        rows.append(cells(*row))
    flow_table = Table(
        caption=f"Participant flow: study sessions of {people(inputs)} comparing "
        f"{wording.name(inputs.reference)} with each other condition. Rules apply from left to "
        "right; a study session counts under the first that removes it.",
        header=(*header, "analysed"),
        rows=tuple(rows),
        data="participant_flow.csv",
    )
    reasons = Table(
        caption="Every excluded study session with its reason.",
        header=("study session", "comparison with", "rule", "reason"),
        rows=tuple(
            cells(e.study_session, others.get(e.comparison, e.comparison), e.rule, e.reason)
            for e in exclusion.exclusions
        ),
        text_columns=4,
        data="exclusions.csv",
    )
    return Section(
        anchor="flow",
        heading="Who is analysed, who is left out",
        paragraphs=(
            _catch_words(inputs),
            *_attention_words(inputs),
            _quality(inputs, findings),
        ),
        tables=(flow_table, *((reasons,) if exclusion.exclusions else ())),
    )


def _catch_words(inputs: ReportInputs) -> str:
    return (
        f"Catch trials show {wording.name(inputs.catch_reference)} beside "
        f"{wording.name(inputs.catch_condition)}. One is failed when any of its questions is not "
        f"answered with a slight or clear preference for {wording.name(inputs.catch_reference)}; "
        f"{_too_many(inputs.max_failed_catch)} the whole study session. "
        "Practice and catch trials are never analysed; practice trials shown again at the end are."
    )


def _attention_words(inputs: ReportInputs) -> tuple[str, ...]:
    if inputs.max_failed_attention is None:
        return ()
    return (
        "Attention checks look like every other page and ask for one certain answer. One is failed "
        "when any of its questions is answered otherwise; "
        f"{_too_many(inputs.max_failed_attention)} the whole study session.",
    )


def _too_many(allowed: int) -> str:
    if not allowed:
        return "any failure excludes"
    return (
        f"more than {wording.count(allowed, 'failure')} {'excludes' if allowed == 1 else 'exclude'}"
    )


def _quality(inputs: ReportInputs, findings: Findings) -> str:
    analysed = findings.exclusion.analysed
    if analysed.empty:
        return "No answers are left to describe."
    ties = 100 * float((analysed["value"] == 0).mean())
    days = sorted({str(moment)[:10] for moment in analysed["answered_at"]})
    span = days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"
    return (
        f"The {len(analysed):,} analysed answers were given on {span}; the median trial took "
        f"{wording.quantity(float(analysed['seconds'].median()))} s, the least share of a trial's "
        f"videos watched was {wording.percent(100 * float(analysed['watched'].min()))}%, and "
        f"{wording.percent(ties)}% of the answers were “no difference”."
    )
