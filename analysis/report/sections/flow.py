"""How the study went: who is analysed, who is left out and why, and looks at results on the way."""

from __future__ import annotations

import math
from functools import partial
from typing import Final

from analysis.answers.exclusion_rules import BY_HAND
from analysis.answers.participants import Flow
from analysis.report import wording
from analysis.report.content import Cell, Section, Table, count_cell, table_of
from analysis.report.subject import Subject
from analysis.results.looks import LooksBefore
from analysis.results.report import TableReport
from motion.errors import listed

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
        ("arm", lambda flow: wording.condition(flow.arm) or "all"),
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
        secondary="Every excluded participant",
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


MOST_LOOKS: Final = 100
"""Rows of the table; ``results.json`` has all."""

MOST_NUMBERS: Final = 5
"""Numbers of participants that a sentence names."""

_WAYS: Final = {"page": "researchers' page", "report": "report", "export": "export"}


def looks_section(report: TableReport) -> Section | None:
    """Return what is logged of looks; None where there were none."""
    found = report.looks
    if not found.count:
        return None
    return Section(
        anchor="looks",
        heading="Looks at results before the end",
        paragraphs=(
            f"{_looks_words(found)} Whoever may stop, extend or change a study because of what a "
            "look shows finds what is not there more often than a p value says: p values and "
            "intervals here take the number of participants for settled beforehand.",
            *_false_positives(found),
        ),
        tables=(_looks_table(found),),
    )


def looks_sentence(report: TableReport) -> str:
    """Return in one sentence that there were looks; '' where there were none."""
    return (
        f"{_looks_words(report.looks).rstrip('.')}; the p values and intervals do not allow for "
        "that."
        if report.looks.count
        else ""
    )


def _looks_words(found: LooksBefore) -> str:
    numbers = [str(number) for number in found.finished]
    if len(numbers) > MOST_NUMBERS:
        at = f"{len(numbers)} numbers of finished participants from {numbers[0]} to {numbers[-1]}"
    else:
        noun = "participant" if numbers == ["1"] else "participants"
        at = f"{listed(numbers)} finished {noun}"
    times = "once" if found.count == 1 else f"{found.count} times"
    return f"Results were looked at {times} before these answers were complete, at {at}."


def _false_positives(found: LooksBefore) -> tuple[str, ...]:
    if math.isnan(found.false_positive_rate):
        return (f"How much likelier cannot be told: {found.reason}.",)
    return (
        "A study that ends at the first of these looks, or of the answers reported here, that "
        f"shows p < {found.level:g} finds what is not there in "
        f"{100 * found.false_positive_rate:.1f}% of cases instead of {100 * found.level:g}%, "
        "for a single test of a normal mean (Armitage, McPherson and Rowe 1969). Where looks could "
        "change nothing, they did no harm; the reasons below are what was said at the time.",
    )


def _looks_table(found: LooksBefore) -> Table:
    shown = found.looks[-MOST_LOOKS:]
    notes = ["Days in UTC. Looks in a row that differ in nothing are one row."]
    if len(shown) < len(found.looks):
        notes.append(f"The last {MOST_LOOKS} rows of {len(found.looks)}; results.json has all.")
    return table_of(
        shown,
        ("Day", lambda look: look.day),
        ("Who", lambda look: look.by),
        ("Where", lambda look: _WAYS.get(look.way, look.way)),
        ("Why", lambda look: look.reason or "not said"),
        ("Finished", lambda look: count_cell(look.finished)),
        ("Planned", lambda look: count_cell(look.planned)),
        ("Times", lambda look: count_cell(look.times)),
        caption="Looks at results before the answers that are reported: who, why, and how many "
        "participants had finished.",
        notes=notes,
        name="looks",
    )
