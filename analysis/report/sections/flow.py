"""The section on participants: who is analysed, who is left out, and why."""

from __future__ import annotations

from functools import partial

from analysis.answers.exclusion_rules import BY_HAND
from analysis.report import wording
from analysis.report.content import Cell, Section, Table, table_of
from analysis.report.headline.words import count_cell
from analysis.report.subject import Subject
from analysis.results.participants import Flow
from analysis.results.report import TableReport

_STAGES = (
    ("places", "places"),
    ("opened", "started"),
    ("withdrawn", "− withdrew"),
    ("earlier", "− earlier design"),
    ("silent", "− no answer"),
)
_COUNTS = ("places", "opened", "withdrawn", "earlier", "unwatched", "completed")


def flow_section(report: TableReport, subject: Subject) -> Section | None:
    """Return who took part, who was left out by which rule, and why."""
    if subject.origin == "none":
        return None
    return Section(
        anchor="flow",
        heading="Who is analysed, who is left out",
        paragraphs=(*_rules(report), *_unwatched(report), *_remarks(report)),
        tables=tuple(table for table in (_flow(report, subject), _reasons(report)) if table.rows),
    )


def _flow(report: TableReport, subject: Subject) -> Table:
    stages = [
        (name, heading)
        for name, heading in _STAGES
        if any(getattr(flow, name) is not None for flow in report.flow)
    ]
    flows = report.flow if len(report.flow) == 1 else (*report.flow, _sum(report.flow))
    return table_of(
        flows,
        ("arm", lambda flow: wording.name(flow.arm) or "all"),
        *((heading, partial(_stage, name)) for name, heading in stages),
        ("answered", lambda flow: _count(flow.answered)),
        *(
            (f"− {_rule(rule.description, rule.exploratory)}", partial(_removed, place))
            for place, rule in enumerate(report.rules)
        ),
        ("analysed", lambda flow: _count(flow.analysed)),
        caption=f"Participant flow: {subject.people}. Rules apply from left to right; a "
        "participant counts under the first that removes them.",
        name="participant_flow",
        data="flow.csv",
    )


def _stage(name: str, flow: Flow) -> Cell:
    return _count(getattr(flow, name))


def _removed(rule: int, flow: Flow) -> Cell:
    return _count(flow.removed[rule])


def _sum(flows: tuple[Flow, ...]) -> Flow:
    def total(name: str) -> int | None:
        known = [getattr(flow, name) for flow in flows if getattr(flow, name) is not None]
        return sum(known) if known else None

    return Flow(
        arm="all",
        **{name: total(name) for name in _COUNTS},
        answered=sum(flow.answered for flow in flows),
        removed=tuple(map(sum, zip(*(flow.removed for flow in flows), strict=True))),
        analysed=sum(flow.analysed for flow in flows),
    )


def _count(number: int | None) -> Cell:
    return Cell(text="–") if number is None else count_cell(number)


def _rule(description: str, exploratory: bool) -> str:
    return f"{description} (exploratory)" if exploratory else description


def _rules(report: TableReport) -> tuple[str, ...]:
    if not report.rules:
        return ("No rule of exclusion applies.",)
    words = []
    if any(rule.exploratory and rule.rule != BY_HAND for rule in report.rules):
        words.append(
            "Rules marked exploratory were added, or changed, after answers could have been seen. "
            "Results that depend on them are hints, not findings."
        )
    by_hand = sum(rule.removed for rule in report.rules if rule.rule == BY_HAND)
    if by_hand:
        words.append(
            f"{wording.count(by_hand, 'participant')} whom the rules before would have kept "
            f"{'was' if by_hand == 1 else 'were'} excluded by hand, by researchers who knew how "
            "the study session went, each for the reason below. No rule decided that beforehand, "
            "so it counts as exploratory: 'With and without exclusions' shows the results without "
            "it."
        )
    return tuple(words)


def _unwatched(report: TableReport) -> tuple[str, ...]:
    ended = sum(flow.unwatched or 0 for flow in report.flow)
    if not ended:
        return ()
    return (
        f"{wording.count(ended, 'study session')} ended before the last trial, since too many "
        "videos were said not to play. They have no completion code, and their places are free.",
    )


def _remarks(report: TableReport) -> tuple[str, ...]:
    return tuple(
        f"{rule.description[:1].upper()}{rule.description[1:]}: {rule.remark}."
        for rule in report.rules
        if rule.remark
    )


def _reasons(report: TableReport) -> Table:
    return table_of(
        report.exclusions.items(),
        ("participant", lambda one: one[0]),
        ("reason", lambda one: one[1]),
        caption="Every excluded participant with the reason.",
        data="exclusions.csv",
    )


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
