"""Participants: their flow, exclusions, interim looks and diagnostics; stills of the videos."""

from dataclasses import fields, replace
from itertools import groupby
from typing import Any, Final

from markupsafe import Markup

from analysis.answers.exclusion_rules import BY_HAND
from analysis.answers.participants import Flow
from analysis.report import wording
from analysis.report.content import Picture, Section, Subject
from analysis.report.sections.preferences import reference_of
from analysis.report.texts import html, paragraphs, sentence, table
from analysis.results.conditions import RankingResults
from analysis.results.headline import Sensitivity
from analysis.results.pairwise import MismatchResults, PairwiseResults
from analysis.results.report import TableReport
from analysis.stats.clustered_mean import LEVEL

_STAGES: Final = (
    ("places", "places"),
    ("opened", "started"),
    ("withdrawn", "− withdrew"),
    ("earlier", "− earlier design"),
    ("silent", "− no answer"),
)


def flow_section(report: TableReport, subject: Subject) -> Section | None:
    """Return who took part, and who was excluded by which rule and why."""
    if subject.origin == "none":
        return None
    flows = report.flow if len(report.flow) == 1 else (*report.flow, _total(report.flow))
    by_hand = [rule for rule in report.rules if rule.rule == BY_HAND]
    tables = (
        table(
            "participant_flow",
            flows,
            people=subject.people,
            rules=report.rules,
            stages=[
                (name, heading)
                for name, heading in _STAGES
                if any(getattr(flow, name) is not None for flow in report.flow)
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
            screened_out=_screened_out(report),
            exploratory=any(rule.exploratory for rule in report.rules if rule not in by_hand),
            by_hand=sum(rule.removed for rule in by_hand),
            unwatched=sum(flow.unwatched or 0 for flow in report.flow),
        ),
        tables=tuple(item for item in tables if item.rows),
    )


def _total(flows: tuple[Flow, ...]) -> Flow:
    """Return the sum over all arms; None if no arm has a number."""
    totals: dict[str, Any] = {}
    for name in (field.name for field in fields(Flow) if field.name not in ("arm", "removed")):
        numbers = [n for flow in flows if (n := getattr(flow, name)) is not None]
        totals[name] = sum(numbers) if numbers else None
    removed = tuple(map(sum, zip(*(flow.removed for flow in flows), strict=True)))
    return replace(flows[0], arm="all", removed=removed, **totals)


def places_words(report: TableReport, subject: Subject) -> str:
    """Return the number of filled places in words; '' if none is open."""
    arms = [flow for flow in report.flow if flow.places is not None]
    is_open = any((flow.completed or 0) < (flow.places or 0) for flow in arms)
    if subject.origin != "participants" or not is_open:
        return ""
    return sentence(
        "participants.places",
        planned=sum(flow.places or 0 for flow in arms),
        filled=sum(min(flow.completed or 0, flow.places or 0) for flow in arms),
    )


def flow_line(report: TableReport, subject: Subject) -> str:
    """Return the participant flow in one line."""
    return sentence(
        "participants.line",
        nobody=subject.origin == "none",
        people=subject.people,
        screened_out=_screened_out(report),
        total=_total(report.flow) if report.flow else None,
        report=report,
    )


def _screened_out(report: TableReport) -> int | None:
    return sum(report.screened_out.values()) if report.screened_out else None


def looks_section(report: TableReport) -> Section | None:
    """Return the logged looks at results; None if there were none."""
    looks = report.looks
    if not looks.count:
        return None
    return Section(
        anchor="looks",
        heading="Looks at results before the end",
        paragraphs=paragraphs("participants.looks_before", looks=looks, sentence=_looked(report)),
        tables=(table("looks", looks.looks),),
    )


def looks_sentence(report: TableReport) -> str:
    """Return one sentence on looks at results; '' if there were none."""
    if not report.looks.count:
        return ""
    return f"{_looked(report)}; the p values and intervals do not correct for that."


def _looked(report: TableReport) -> str:
    return sentence("participants.looked", looks=report.looks)


def diagnostics_section(report: TableReport, subject: Subject) -> Section | None:
    """Return side bias, agreement and response times; None without answers."""
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
        retested = [row for row in results.test_retest.rows() if row.result.n]
        tables.append(table("agreement_table", results.agreement.rows()))
        tables.append(table("test_retest_table", retested))
    return Section(
        anchor="diagnostics",
        heading="How the answers were given",
        paragraphs=paragraphs(
            "participants.diagnostics",
            people=subject.people,
            times=report.quality.response_seconds,
            straight_lining=report.quality.straight_lining,
        ),
        tables=tuple(item for item in tables if item.rows),
    )


def sensitivity_section(report: TableReport, subject: Subject) -> Section | None:
    """Return the headline numbers with and without exclusions; None if nobody is excluded."""
    if not report.sensitivity:
        return None
    results, reference = report.results, None
    if isinstance(results, PairwiseResults) and results.comparisons:
        reference = reference_of(results.comparisons, subject.reference)
    # The reference comes first, as in the headline.
    shown = [
        _mirrored(entry)
        if reference is not None and entry.conditions[1:] == (reference,)
        else entry
        for entry in report.sensitivity
    ]
    is_planned = all(entry.is_as_planned for entry in shown)
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
                names=lambda entry: " against ".join(map(wording.condition, entry.conditions)),
                formatted=wording.number_style(measure),
            ),
        ),
    )


def _mirrored(entry: Sensitivity) -> Sensitivity:
    return replace(
        entry,
        conditions=entry.conditions[::-1],
        analysed=entry.analysed.mirrored(),
        as_planned=entry.as_planned.mirrored(),
        everyone=entry.everyone.mirrored(),
    )


def truth_section(subject: Subject) -> Section | None:
    """Return how a rehearsal's estimates compare with the true values of its raters."""
    if not subject.truth:
        return None
    intervals = sum(estimate.has_interval for _, estimate in subject.truth)
    return Section(
        anchor="truth",
        heading="Known truth against estimate",
        paragraphs=paragraphs(
            "participants.truth",
            inside=sum(estimate.covers(truth.value) for truth, estimate in subject.truth),
            intervals=intervals,
            missing=f"{100 * (1 - LEVEL**intervals):.0f}",
        ),
        tables=(table("truth", subject.truth),),
    )


def stills_section(subject: Subject) -> Section | None:
    """Return a row of stills for each condition, or why there are none; None for a table."""
    section = Section(anchor="stills", heading="What the conditions look like")
    if not subject.stills:
        no_stills = subject.no_stills
        return replace(section, paragraphs=(no_stills,)) if no_stills else None
    segment = subject.stills[0].segment
    rows = {name: list(row) for name, row in groupby(subject.stills, lambda s: s.condition)}
    excerpt = subject.excerpts.get(segment)
    picture = Picture(
        svg=Markup(html("stills.html", rows=rows, condition=wording.condition)),  # noqa: S704
        caption=f"Segment {wording.name(segment)}: a row for each condition and a column for each "
        "time, in seconds from the start.",
    )
    return replace(
        section,
        paragraphs=paragraphs(
            "participants.stills",
            segment=segment,
            transcript=excerpt.transcript if excerpt else "",
            missing=[wording.condition(name) for name in subject.conditions if name not in rows],
        ),
        pictures=(picture,),
    )
