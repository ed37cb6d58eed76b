"""The report's first words: what was asked, answered in about three sentences."""

from __future__ import annotations

from analysis.preferences.win_share import Preference
from analysis.report import wording
from analysis.report.findings import Findings, verdict
from analysis.report.inputs import ReportInputs


def people(inputs: ReportInputs) -> str:
    """Return what to call those who answered."""
    return "simulated raters" if inputs.origin == "rehearsal" else "participants"


def answer(inputs: ReportInputs, findings: Findings) -> tuple[str, ...]:
    """Return the answer, one sentence per question and one on what it rests on."""
    if inputs.origin == "none":
        return (
            "No participant has answered yet, so this report says nothing about preference.",
            *_metrics_only(findings),
        )
    if not findings.exclusion.sessions_analysed:
        return (
            f"None of the {findings.exclusion.sessions_answered} study sessions passed the "
            "exclusion rules, so there is no result; the tables show what is there without them.",
        )
    return (
        *(_about(question, inputs, findings) for question in figure_order(inputs)),
        _basis(inputs, findings),
    )


def figure_order(inputs: ReportInputs) -> tuple[str, ...]:
    """Return the questions as figures show them: emotion first, as AMUSE's Figure 6 does."""
    return tuple(sorted(inputs.questions, key=lambda question: "emotion" not in question))


def flow_line(inputs: ReportInputs, findings: Findings) -> str:
    """Return the participant flow in one line."""
    if inputs.origin == "none":
        return "Participant flow: nobody has taken part yet."
    exclusion = findings.exclusion
    steps = []
    if inputs.study_sessions is not None:
        steps.append(f"{sum(inputs.study_sessions.values())} started")
    steps.append(f"{exclusion.sessions_answered} answered")
    steps += [f"{o.removed} excluded ({o.description})" for o in exclusion.outcomes if o.removed]
    if not exclusion.exclusions:
        steps.append("none excluded")
    steps.append(f"{exclusion.sessions_analysed} analysed")
    return f"{people(inputs).capitalize()}: {' → '.join(steps)}."


def _about(question: str, inputs: ReportInputs, findings: Findings) -> str:
    found = [p for p in findings.preferences if p.question == question]
    won = [p for p in found if verdict(p) == "reference"]
    lost = [p for p in found if verdict(p) == "other"]
    open_ = [p for p in found if verdict(p) == "undecided"]
    reference = wording.name(inputs.reference)
    clauses = []
    if won:
        against = wording.listing([_with_numbers(p) for p in won])
        clauses.append(f"{people(inputs)} preferred {reference} to {against}")
    if lost:
        against = wording.listing([_with_numbers(p) for p in lost])
        clauses.append(
            f"{'they' if clauses else people(inputs)} preferred {against} to {reference}"
        )
    if open_:
        against = wording.listing([_with_numbers(p) for p in open_])
        clauses.append(f"the answers do not decide between {reference} and {against}")
    return f"On {wording.name(question)}, {'; '.join(clauses)}."


def _with_numbers(preference: Preference) -> str:
    return (
        f"{wording.name(preference.other)} "
        f"({wording.name(preference.reference)} wins {wording.estimate(preference.win_share)})"
    )


def _basis(inputs: ReportInputs, findings: Findings) -> str:
    exclusion = findings.exclusion
    analysed = exclusion.analysed
    changed = [
        f"{wording.name(kept.other)} on {wording.name(kept.question)}"
        for kept, everyone in zip(findings.preferences, findings.everyone, strict=True)
        if verdict(kept) != verdict(everyone)
    ]
    out = len(exclusion.exclusions)
    if not out:
        effect = "nobody was excluded"
    elif changed:
        effect = (
            f"with the {out} excluded, the conclusion would differ for {wording.listing(changed)}"
        )
    else:
        effect = f"with the {out} excluded, every conclusion would be the same"
    return (
        f"This rests on {wording.count(len(analysed), 'answer')} by "
        f"{exclusion.sessions_analysed} of {exclusion.sessions_answered} {people(inputs)} about "
        f"{wording.count(analysed['segment'].nunique(), 'segment')} of "
        f"{wording.count(analysed['speaker'].nunique(), 'speaker')}; {effect}."
    )


def _metrics_only(findings: Findings) -> tuple[str, ...]:
    conditions = {score.condition for score in findings.metrics.conditions}
    if not conditions:
        return ()
    return (
        f"It shows the automatic metrics of {wording.count(len(conditions), 'condition')}; "
        "they do not tell what people prefer.",
    )
