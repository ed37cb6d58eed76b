"""The participant flow in words."""

from __future__ import annotations

from analysis.report import wording
from analysis.report.subject import Subject
from analysis.results.report import TableReport


def is_half_finished(report: TableReport, subject: Subject) -> bool:
    """Tell whether places of the study are still waiting for somebody to complete them."""
    return subject.origin == "participants" and any(
        flow.places is not None and (flow.completed or 0) < flow.places for flow in report.flow
    )


def places_words(report: TableReport) -> str:
    """Return how many places are filled."""
    known = [flow for flow in report.flow if flow.places is not None]
    places = sum(flow.places or 0 for flow in known)
    filled = sum(min(flow.completed or 0, flow.places or 0) for flow in known)
    return f"{filled} of {wording.count(places, 'place')} are filled"


def flow_line(report: TableReport, subject: Subject) -> str:
    """Return the participant flow in one line."""
    if subject.origin == "none":
        return "Participant flow: nobody has answered yet."
    opened = sum(flow.opened for flow in report.flow if flow.opened is not None)
    known = any(flow.opened is not None for flow in report.flow)
    started = f"{opened} started, " if known else ""
    removed = [f" − {rule.removed} {rule.description}" for rule in report.rules if rule.removed]
    return (
        f"{subject.people.capitalize()}: {started}{report.participants.recruited} answered"
        f"{''.join(removed) or ' − 0 excluded'} = {report.participants.attentive} analysed."
    )
