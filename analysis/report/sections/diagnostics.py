"""The section on how answers were given: sides, agreement, consistency, speed."""

from __future__ import annotations

import math
from typing import Final

from analysis.answers.quality import Quality
from analysis.report import wording
from analysis.report.content import (
    Column,
    Section,
    Table,
    count_cell,
    p_cell,
    share_cell,
    table_of,
)
from analysis.report.subject import Subject
from analysis.report.wording import between, question_name
from analysis.results.agreement import Agreement
from analysis.results.grouping import ByQuestion
from analysis.results.pairwise import MismatchResults, OwnSideBias, PairwiseResults, SideBias
from analysis.results.ranking import RankingResults
from analysis.results.report import TableReport
from analysis.stats.agreement import Retest
from analysis.stats.clustered_mean import Estimate
from analysis.stats.friedman import Concordance
from analysis.stats.intraclass import Intraclass

DESCRIBED = (
    "Nothing here excludes anybody or decides anything; low agreement does not rule out a real "
    "difference."
)

_QUESTION: Final[Column[tuple[str, str, object]]] = (
    "question",
    lambda row: question_name(row[0], row[1]),
)


def diagnostics_section(report: TableReport, subject: Subject) -> Section | None:
    """Return what the answers say about themselves; None where there are none."""
    if subject.origin == "none" or not report.participants.recruited:
        return None
    results = report.results
    tables = []
    if isinstance(results, PairwiseResults | MismatchResults):
        tables.append(_sides(results))
    if isinstance(results, RankingResults):
        tables.append(_concordance(results.kendall_w))
    else:
        tables += [
            _agreement(results.agreement),
            _retest(results.test_retest),
        ]
    return Section(
        anchor="diagnostics",
        heading="How the answers were given",
        paragraphs=(DESCRIBED, *_speed(report.quality, subject), *_alike(report.quality, subject)),
        tables=tuple(table for table in tables if table.rows),
    )


def _sides(results: PairwiseResults | MismatchResults) -> Table:
    biases: ByQuestion[SideBias | OwnSideBias] = results.side_bias
    first = "own speech" if isinstance(results, MismatchResults) else "first condition"
    return table_of(
        [*biases.rows()],
        _QUESTION,
        ("left share", lambda row: share_cell(row[2].left_share.estimate)),
        (
            "95% interval",
            lambda row: _of_share(row[2].left_share),
        ),
        ("p", lambda row: p_cell(row[2].left_share.p_value)),
        (
            f"{first} on the left",
            lambda row: share_cell(
                row[2].own_on_left if isinstance(row[2], OwnSideBias) else row[2].a_on_left
            ),
        ),
        caption="Side bias: share of analysed answers for the left side, ties counting one half, "
        "tested against .5 (two-way clustered); and how often the "
        f"{first} of a comparison stood on the left.",
        notes=(
            "A bias to one side pulls win shares towards .5; it favours a condition only as far as "
            "the sides were not balanced. The model takes it out of the net preference.",
        ),
        name="side_bias_table",
        data="side_bias.csv",
    )


def _agreement(found: ByQuestion[Agreement]) -> Table:
    return table_of(
        found.rows(),
        _QUESTION,
        ("α", lambda row: share_cell(row[2].estimate)),
        ("95% interval", lambda row: _interval(row[2].low, row[2].high, row[2].reason)),
        ("ICC(A,1)", lambda row: share_cell(row[2].icc.single.estimate)),
        (
            "95% interval",
            lambda row: _of_icc(row[2].icc),
        ),
        ("ICC(A,k)", lambda row: share_cell(row[2].icc.average.estimate)),
        ("answers", lambda row: count_cell(row[2].n)),
        ("items", lambda row: count_cell(row[2].items)),
        ("participants", lambda row: count_cell(row[2].participants)),
        caption="Agreement between participants about the same item: Krippendorff's α for ordered "
        "answers (1 is full agreement, 0 what chance gives), its interval over items; intraclass "
        "correlation of one participant's answers, ICC(A,1), and of the means over an item's "
        "participants, ICC(A,k).",
        name="agreement_table",
        data="agreement.csv",
    )


def _retest(found: ByQuestion[Retest]) -> Table:
    return table_of(
        [row for row in found.rows() if row[2].n],
        _QUESTION,
        ("trials", lambda row: count_cell(row[2].n)),
        ("κ", lambda row: share_cell(row[2].kappa)),
        ("95% interval", lambda row: _interval(row[2].low, row[2].high, row[2].reason)),
        ("equal", lambda row: share_cell(row[2].equal_share)),
        ("ρ", lambda row: share_cell(row[2].spearman)),
        caption="Test and retest: practice trials against the same trials shown again at the end. "
        "Cohen's κ with quadratic weights, its interval over participants; the share of equal "
        "answers; Spearman's rank correlation.",
        name="test_retest_table",
        data="test_retest.csv",
    )


def _concordance(found: ByQuestion[Concordance]) -> Table:
    rows = [*found.rows()]
    return table_of(
        rows,
        _QUESTION,
        ("W, mean over segments", lambda row: share_cell(row[2].estimate)),
        ("W of mean ranks", lambda row: share_cell(row[2].overall)),
        ("participants", lambda row: str(row[2].n)),
        caption="Agreement between participants: Kendall's W (1 where all rank alike, 0 where "
        "ranks cancel out), mean over segments, and of participants' mean ranks.",
        notes=(
            f"{question_name(of, question)}: {one.reason}."
            for of, question, one in rows
            if one.reason
        ),
        name="kendall_w_table",
        data="kendall_w.csv",
    )


def _of_share(found: Estimate) -> str:
    return _interval(found.low, found.high, found.reason)


def _of_icc(found: Intraclass) -> str:
    return _interval(found.single.low, found.single.high, found.reason)


def _interval(low: float, high: float, reason: str) -> str:
    if math.isnan(low) or math.isnan(high):
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
