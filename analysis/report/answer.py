"""The report's first words: what was asked, answered in about three sentences."""

from __future__ import annotations

from typing import get_args

from analysis.preferences.clustered import LEVEL
from analysis.preferences.win_share import Preference
from analysis.report import wording
from analysis.report.findings import Findings, Verdict, verdict
from analysis.report.inputs import ReportInputs
from motion.listing import listed


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
            "exclusion rules, so there is no result; the table of win shares also shows what they "
            "answered.",
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
    started = ""
    if inputs.study_sessions is not None:
        started = f"{sum(inputs.study_sessions.values())} started, "
    removed = [f" − {o.removed} {o.description}" for o in exclusion.outcomes if o.removed]
    return (
        f"{people(inputs).capitalize()}: {started}{exclusion.sessions_answered} answered"
        f"{''.join(removed) or ' − 0 excluded'} = {exclusion.sessions_analysed} analysed."
    )


def _about(question: str, inputs: ReportInputs, findings: Findings) -> str:
    found = [p for p in findings.preferences if p.question == question]
    reference = wording.name(inputs.reference)
    sides = {side: [p for p in found if verdict(p) == side] for side in get_args(Verdict)}
    first = next(p for side in sides.values() for p in side)
    named = {
        side: [_with_numbers(p, full=p is first) for p in preferences]
        for side, preferences in sides.items()
    }
    clauses = []
    if named["reference"]:
        clauses.append(f"{people(inputs)} preferred {reference} to {listed(named['reference'])}")
    if named["other"]:
        subject = "they" if clauses else people(inputs)
        clauses.append(f"{subject} preferred {listed(named['other'])} to {reference}")
    if named["undecided"]:
        one_of = {1: "", 2: "either of "}.get(len(named["undecided"]), "any of ")
        others = f"{one_of}{listed(named['undecided'])}"
        clauses.append(f"the answers do not decide between {reference} and {others}")
    if named["untested"]:
        clauses.append(f"there is no test of {reference} against {listed(named['untested'])}")
    return f"On {wording.name(question)}, {'; '.join(clauses)}."


def _with_numbers(preference: Preference, *, full: bool) -> str:
    """Return the other condition with the reference's win share; `full` says what that is."""
    mean = preference.win_share
    other = wording.name(preference.other)
    if not mean.answers:
        return f"{other} (no answers)"
    share = wording.share(mean.estimate)
    if full:
        share = f"win share of {wording.name(preference.reference)} {share}"
    if mean.reason:
        return f"{other} ({share}, {mean.reason})"
    if not full:
        return f"{other} ({wording.estimate(mean)})"
    return f"{other} ({share}, {LEVEL:.0%} interval {wording.interval(mean)})"


def _basis(inputs: ReportInputs, findings: Findings) -> str:
    exclusion = findings.exclusion
    analysed = exclusion.analysed
    changed = [
        f"{wording.name(kept.other)} on {wording.name(kept.question)}"
        for kept, everyone in zip(findings.preferences, findings.everyone, strict=True)
        if verdict(kept) != verdict(everyone)
    ]
    if not exclusion.exclusions:
        effect = "nobody was excluded"
    elif changed:
        effect = f"had nobody been excluded, the conclusion would differ for {listed(changed)}"
    else:
        effect = "had nobody been excluded, every conclusion would be the same"
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
