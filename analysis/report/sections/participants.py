"""Who is analysed, and what they saw: participant flow, looks on the way, how they answered."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from itertools import groupby
from typing import Any, Final

from markupsafe import Markup

from analysis.answers.exclusion_rules import BY_HAND
from analysis.answers.participants import Flow
from analysis.report import wording
from analysis.report.content import Picture, Section
from analysis.report.sections.preferences import reference_of
from analysis.report.subject import Still, Subject
from analysis.report.texts import paragraphs, sentence, table
from analysis.results.headline import Sensitivity
from analysis.results.known_values import found_values
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL

_STAGES: Final = (
    ("places", "places"),
    ("opened", "started"),
    ("withdrawn", "− withdrew"),
    ("earlier", "− earlier design"),
    ("silent", "− no answer"),
)

MOST_LOOKS: Final = 100
"""Rows of the table; ``results.json`` has all."""


def flow_section(report: TableReport, subject: Subject) -> Section | None:
    """Return who took part, who was left out by which rule, and why."""
    if subject.origin == "none":
        return None
    flows = report.flow if len(report.flow) == 1 else (*report.flow, _sum(report.flow))
    by_hand = [rule for rule in report.rules if rule.rule == BY_HAND]
    tables = (
        table(
            "participant_flow",
            flows,
            people=subject.people,
            rules=report.rules,
            stages=[
                stage
                for stage in _STAGES
                if any(getattr(flow, stage[0]) is not None for flow in report.flow)
            ],
        ),
        table("exclusions", report.exclusions.items()),
    )
    return Section(
        anchor="flow",
        heading="Who is analysed, who is left out",
        paragraphs=paragraphs(
            "participants.flow",
            report=report,
            exploratory=any(rule.exploratory for rule in report.rules if rule not in by_hand),
            by_hand=sum(rule.removed for rule in by_hand),
            unwatched=sum(flow.unwatched or 0 for flow in report.flow),
        ),
        tables=tuple(one for one in tables if one.rows),
    )


def _sum(flows: tuple[Flow, ...]) -> Flow:
    columns: dict[str, Any] = {
        one.name: [getattr(flow, one.name) for flow in flows] for one in fields(Flow)
    }
    totals: dict[str, Any] = {
        name: sum(known) if (known := [one for one in column if one is not None]) else None
        for name, column in columns.items()
        if name not in ("arm", "removed")
    }
    removed = tuple(map(sum, zip(*columns["removed"], strict=True)))
    return replace(flows[0], arm="all", removed=removed, **totals)


def is_half_finished(report: TableReport, subject: Subject) -> bool:
    """Tell whether places of the study are still waiting for somebody to complete them."""
    return subject.origin == "participants" and any(
        flow.places is not None and (flow.completed or 0) < flow.places for flow in report.flow
    )


def places_words(report: TableReport, subject: Subject) -> str:
    """Return how many places are filled; '' where none waits."""
    if not is_half_finished(report, subject):
        return ""
    known = [flow for flow in report.flow if flow.places is not None]
    return sentence(
        "participants.places",
        wanted=sum(flow.places or 0 for flow in known),
        filled=sum(min(flow.completed or 0, flow.places or 0) for flow in known),
    )


def flow_line(report: TableReport, subject: Subject) -> str:
    """Return the participant flow in one line."""
    opened = [flow.opened for flow in report.flow if flow.opened is not None]
    return sentence(
        "participants.line",
        nobody=subject.origin == "none",
        people=subject.people,
        opened=sum(opened) if opened else None,
        report=report,
    )


def looks_section(report: TableReport) -> Section | None:
    """Return what is logged of looks; None where there were none."""
    found = report.looks
    if not found.count:
        return None
    return Section(
        anchor="looks",
        heading="Looks at results before the end",
        paragraphs=paragraphs("participants.before", looks=found, told=_looked(report)),
        tables=(table("looks", found.looks[-MOST_LOOKS:], all=len(found.looks)),),
    )


def looks_sentence(report: TableReport) -> str:
    """Return in one sentence that there were looks; '' where there were none."""
    if not report.looks.count:
        return ""
    return f"{_looked(report)}; the p values and intervals do not allow for that."


def _looked(report: TableReport) -> str:
    return sentence("participants.looked", looks=report.looks)


def diagnostics_section(report: TableReport, subject: Subject) -> Section | None:
    """Return what the answers say about themselves; None where there are none."""
    if subject.origin == "none" or not report.participants.recruited:
        return None
    results, tables = report.results, []
    if isinstance(results, PairwiseResults | MismatchResults):
        is_pair = isinstance(results, PairwiseResults)
        tables.append(
            table(
                "side_bias_table",
                results.side_bias.rows(),
                first="first condition" if is_pair else "own speech",
            )
        )
    if isinstance(results, RankingResults):
        tables.append(table("kendall_w_table", results.kendall_w.rows()))
    else:
        again = [row for row in results.test_retest.rows() if row.found.n]
        tables.append(table("agreement_table", results.agreement.rows()))
        tables.append(table("test_retest_table", again))
    return Section(
        anchor="diagnostics",
        heading="How the answers were given",
        paragraphs=paragraphs(
            "participants.given",
            people=subject.people,
            times=report.quality.response_seconds,
            alike=report.quality.straight_lining,
        ),
        tables=tuple(one for one in tables if one.rows),
    )


def sensitivity_section(report: TableReport, subject: Subject) -> Section | None:
    """Return the headline numbers with and without exclusions; None where nobody is left out."""
    if not report.sensitivity:
        return None
    results, side = report.results, None
    if isinstance(results, PairwiseResults) and results.comparisons:
        side = reference_of(results.comparisons, subject.reference)
    # The reference stands first, as in the headline.
    shown = [
        _turned(one) if side is not None and one.conditions[1:] == (side,) else one
        for one in report.sensitivity
    ]
    is_planned = all(one.is_as_planned for one in shown)
    groups = {"analysed": "analysed", "as_planned": "as planned", "everyone": "nobody excluded"}
    if is_planned:
        del groups["as_planned"]
    measure = shown[0].measure
    return Section(
        anchor="sensitivity",
        heading="With and without exclusions",
        paragraphs=paragraphs("participants.sensitivity", is_planned=is_planned),
        tables=(
            table(
                "sensitivity_table",
                shown,
                measure=wording.MEASURES[measure],
                groups=groups,
                of=lambda one: " – ".join(map(wording.condition, one.conditions)),
                words=wording.number_style(measure),
            ),
        ),
    )


def _turned(one: Sensitivity) -> Sensitivity:
    return replace(
        one,
        conditions=one.conditions[::-1],
        analysed=one.analysed.mirrored(),
        as_planned=one.as_planned.mirrored(),
        everyone=one.everyone.mirrored(),
    )


def truth_section(reports: Sequence[TableReport], subject: Subject) -> Section | None:
    """Return how a rehearsal's estimates compare with what its raters were given."""
    pairs = found_values(reports, subject.truth)
    if not pairs:
        return None
    intervals = sum(found.has_interval for _, found in pairs)
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=paragraphs(
            "participants.truth",
            inside=sum(found.covers(known.value) for known, found in pairs),
            intervals=intervals,
            missing=f"{100 * (1 - LEVEL**intervals):.0f}",
        ),
        tables=(table("truth", pairs),),
    )


ANCHOR = "stills"
HEADING = "What the conditions look like"


def strip_section(subject: Subject) -> Section | None:
    """Return a row of stills for each condition; None where there cannot be any."""
    if not subject.stills:
        said = (subject.no_stills,)
        return Section(anchor=ANCHOR, heading=HEADING, paragraphs=said) if said[0] else None
    segment = subject.stills[0].segment
    rows = {name: list(own) for name, own in groupby(subject.stills, lambda one: one.condition)}
    excerpt = subject.excerpts.get(segment)
    picture = Picture(
        svg=_strip(rows),
        caption=f"Segment {wording.name(segment)}: each row is a condition, each column a moment "
        "in seconds from the beginning.",
    )
    return Section(
        anchor=ANCHOR,
        heading=HEADING,
        paragraphs=paragraphs(
            "participants.stills",
            segment=segment,
            said=excerpt.transcript if excerpt else "",
            missing=[wording.condition(name) for name in subject.conditions if name not in rows],
        ),
        pictures=(picture,),
    )


def _strip(rows: dict[str, list[Still]]) -> Markup:
    """Return the stills as a table of pictures, each with words for those who cannot see it."""
    head = (
        Markup('<th scope="col">{:.1f} s{}</th>').format(
            still.seconds, f" “{still.word}”" if still.word else ""
        )
        for still in next(iter(rows.values()))
    )
    body = (
        Markup('<tr><th scope="row">{}</th>{}</tr>').format(
            wording.condition(name), Markup("").join(map(_cell, stills))
        )
        for name, stills in rows.items()
    )
    return Markup(
        '<table class="stills"><thead><tr><td></td>{}</tr></thead><tbody>{}</tbody></table>'
    ).format(Markup("").join(head), Markup("").join(body))


def _cell(still: Still) -> Markup:
    said = f", at “{still.word}”" if still.word else ""
    words = f"{wording.condition(still.condition)} after {still.seconds:.1f} seconds{said}"
    return Markup('<td><img src="{}" alt="{}"></td>').format(still.image, words)
