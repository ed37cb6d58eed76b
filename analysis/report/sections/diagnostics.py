"""The section on how answers were given: sides, agreement, consistency, speed."""

from __future__ import annotations

from analysis.answers.quality import Quality
from analysis.report import wording
from analysis.report.by_question import each_question, question_name
from analysis.report.content import Cell, Section, Table, cells
from analysis.report.headline.words import between, count_cell, p_cell, share_cell
from analysis.report.subject import Subject
from analysis.results.agreement import Agreement
from analysis.results.grouping import ByQuestion
from analysis.results.mismatch import MismatchResults
from analysis.results.pairwise import PairwiseResults
from analysis.results.ranking import RankingResults
from analysis.results.report import TableReport
from analysis.stats.rankings.kendall_w import Concordance
from analysis.stats.retest import Retest

DESCRIBED = (
    "Nothing here excludes anybody or decides anything; low agreement does not rule out a real "
    "difference."
)


def diagnostics_section(report: TableReport, subject: Subject) -> Section | None:
    """Return what the answers say about themselves; None where there are none."""
    if subject.origin == "none" or not report.participants.recruited:
        return None
    results = report.results
    tables = []
    if isinstance(results, PairwiseResults | MismatchResults):
        tables.append(_sides(results, report.sets))
    if isinstance(results, RankingResults):
        tables.append(_concordance(results.kendall_w, report.sets))
    else:
        tables += [
            _agreement(results.agreement, report.sets),
            _retest(results.test_retest, report.sets),
        ]
    return Section(
        anchor="diagnostics",
        heading="How the answers were given",
        paragraphs=(DESCRIBED, *_speed(report.quality, subject), *_alike(report.quality, subject)),
        tables=tuple(table for table in tables if table.rows),
    )


def _sides(results: PairwiseResults | MismatchResults, sets: tuple[str, ...]) -> Table:
    first, found = "own speech", []
    if isinstance(results, MismatchResults):
        for of, question, own in each_question(results.side_bias, sets):
            found.append((question_name(of, question), own.left_share, own.own_on_left))
    else:
        first = "first condition"
        for of, question, one in each_question(results.side_bias, sets):
            found.append((question_name(of, question), one.left_share, one.a_on_left))
    rows = [
        (
            Cell(text=name),
            share_cell(left.estimate),
            Cell(text=_interval(left.low, left.high, left.reason)),
            p_cell(left.p_value),
            share_cell(on_left),
        )
        for name, left, on_left in found
    ]
    return Table(
        caption="Side bias: share of analysed answers for the left side, ties counting one half, "
        "tested against .5 (two-way clustered); and how often the "
        f"{first} of a comparison stood on the left.",
        header=("question", "left share", "95 % interval", "p", f"{first} on the left"),
        rows=tuple(rows),
        notes=(
            "A bias to one side pulls win shares towards .5; it favours a condition only as far as "
            "the sides were not balanced. The model takes it out of the net preference.",
        ),
        name="side_bias_table",
        data="side_bias.csv",
    )


def _agreement(found: ByQuestion[Agreement], sets: tuple[str, ...]) -> Table:
    rows = tuple(
        (
            Cell(text=question_name(of, question)),
            share_cell(one.estimate),
            Cell(text=_interval(one.low, one.high, one.reason)),
            share_cell(one.icc.single.estimate),
            Cell(text=_interval(one.icc.single.low, one.icc.single.high, one.icc.reason)),
            share_cell(one.icc.average.estimate),
            count_cell(one.n),
            count_cell(one.items),
            count_cell(one.participants),
        )
        for of, question, one in each_question(found, sets)
    )
    return Table(
        caption="Agreement between participants about the same item: Krippendorff's α for ordered "
        "answers (1 is full agreement, 0 what chance gives), its interval over items; intraclass "
        "correlation of one participant's answers, ICC(A,1), and of the means over an item's "
        "participants, ICC(A,k).",
        header=(
            *("question", "α", "95 % interval", "ICC(A,1)", "95 % interval", "ICC(A,k)"),
            *("answers", "items", "participants"),
        ),
        rows=rows,
        name="agreement_table",
        data="agreement.csv",
    )


def _retest(found: ByQuestion[Retest], sets: tuple[str, ...]) -> Table:
    rows = tuple(
        (
            Cell(text=question_name(of, question)),
            count_cell(one.n),
            share_cell(one.kappa),
            Cell(text=_interval(one.low, one.high, one.reason)),
            share_cell(one.equal_share),
            share_cell(one.spearman),
        )
        for of, question, one in each_question(found, sets)
        if one.n
    )
    return Table(
        caption="Test and retest: practice trials against the same trials shown again at the end. "
        "Cohen's κ with quadratic weights, its interval over participants; the share of equal "
        "answers; Spearman's rank correlation.",
        header=("question", "trials", "κ", "95 % interval", "equal", "ρ"),
        rows=rows,
        name="test_retest_table",
        data="test_retest.csv",
    )


def _concordance(found: ByQuestion[Concordance], sets: tuple[str, ...]) -> Table:
    rows = tuple(
        (
            Cell(text=question_name(of, question)),
            share_cell(one.estimate),
            share_cell(one.overall),
            *cells(str(one.n)),
        )
        for of, question, one in each_question(found, sets)
    )
    reasons = [
        f"{question_name(of, question)}: {one.reason}."
        for of, question, one in each_question(found, sets)
        if one.reason
    ]
    return Table(
        caption="Agreement between participants: Kendall's W (1 where all rank alike, 0 where "
        "ranks cancel out), mean over segments, and of participants' mean ranks.",
        header=("question", "W, mean over segments", "W of mean ranks", "participants"),
        rows=rows,
        notes=tuple(reasons),
        name="kendall_w_table",
        data="kendall_w.csv",
    )


def _interval(low: float, high: float, reason: str) -> str:
    if low != low or high != high:
        return f"none: {reason}" if reason else "none"
    return between(wording.share(low), wording.share(high))


def _speed(quality: Quality, subject: Subject) -> tuple[str, ...]:
    times = quality.response_seconds
    if times.reason:
        return (f"Response times: {times.reason}.",)
    fast = len(times.too_fast)
    return (
        f"Response times: half of the {subject.people} had a median between "
        f"{wording.quantity(times.low_quartile)} and {wording.quantity(times.high_quartile)} s "
        f"(median {wording.quantity(times.median)} s); {fast or 'none'} took less than half of "
        "that.",
    )


def _alike(quality: Quality, subject: Subject) -> tuple[str, ...]:
    lines = quality.straight_lining
    return (
        f"Straight-lining: {len(lines.participants) or 'none'} of the {subject.people} gave one "
        f"answer in at least {lines.limit:.0%} of the trials.",
    )
