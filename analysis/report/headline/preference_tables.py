"""Preferences in tables: as AMUSE's Table A.5, in full, with intervals, and as published."""

from __future__ import annotations

from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.by_question import table_by_question
from analysis.report.content import Cell, Table, cells
from analysis.report.headline.preference_rows import PreferenceGroup, PreferenceRow, levels
from analysis.report.headline.words import (
    CLUSTERED,
    count_cell,
    counted,
    gathered,
    of_set,
    p_cell,
    plus_minus,
    share_words,
)
from analysis.stats.clustered_mean import LEVEL
from analysis.stats.clustered_variance import TWO_WAY

INSTEAD: Final = MappingProxyType(
    {
        "clmm": "the mixed model",
        "win_share": "the win share",
        "sign": "the exact sign test of participants, who alone are taken as a sample",
    }
)
"""What a p value is one of."""


def sums_table(group: PreferenceGroup, *, name: str, data: str) -> Table:
    """Return the percentages for the one, for the other and for neither."""
    caption = (
        f"{of_set(group.set)}Preferences in the layout of AMUSE's Table A.5: clear and slight "
        f"preferences for {group.one} and for {group.other}, in % of the n answers after "
        "exclusions. That table leaves “no difference” out; here it stands beside. The larger "
        "share is bold, which is no test."
    )
    return table_by_question(
        {(row.label, row.question): _sums(row) for row in group.rows},
        group.heading,
        (group.one, group.other, "no difference", "n"),
        caption=caption,
        name=name,
        data=data,
    )


def counts_table(group: PreferenceGroup, *, name: str, data: str) -> Table:
    """Return how many gave each of the five answers."""
    return Table(
        caption=f"{of_set(group.set)}Answers after exclusions: number, and % of the row.",
        header=("question", group.heading, *levels(group.one, group.other), "answers"),
        rows=tuple(
            (
                *cells(wording.heading(row.question), row.label),
                *(
                    counted(count, f"{count} ({percent:.0f})" if row.n else "–")
                    for count, percent in zip(row.levels, row.percentages, strict=True)
                ),
                count_cell(row.n),
            )
            for row in group.rows
        ),
        text_columns=2,
        notes=("Rounded percentages may not add up to 100.",),
        name=name,
        data=data,
    )


def win_share_table(group: PreferenceGroup, *, name: str, data: str) -> Table:
    """Return the headline numbers: win share with its interval, and the model's net preference."""
    return Table(
        caption=f"{of_set(group.set)}Win share of {group.one}: preferences for it plus half of "
        "“no difference”, as a share of all answers, with its "
        f"{LEVEL:.0%} interval, clustered by participant and segment ({CLUSTERED}). Log-odds: "
        "net preference in a cumulative link mixed model with crossed effects of participants and "
        "segments; p by its likelihood ratio, or of what a note names in its place, corrected by "
        "Holm over the report's family of tests. After exclusions.",
        header=(
            *("question", group.heading, "participants", "answers"),
            *(f"win share, {LEVEL:.0%} interval", "log-odds", "p", f"p{wording.NO_BREAK}(Holm)"),
        ),
        rows=tuple(_headline(row) for row in group.rows),
        text_columns=2,
        notes=(
            "Participants: those analysed, of those who took part in the comparison.",
            *_reasons(group),
        ),
        name=name,
        data=data,
    )


def further_table(group: PreferenceGroup, *, name: str, data: str) -> Table:
    """Return what stands beside the headline: without exclusions, by other tests, as published."""
    ignored = dict.fromkeys(words for row in group.rows for words in row.as_published.ignores)
    return Table(
        caption=f"{of_set(group.set)}Beside the headline. Nobody excluded: the win share over all "
        "who answered. Further tests: exact ones over participants' means, which take the "
        "segments as the only ones of interest, and min F′, which is conservative. As published: "
        "what papers report, all answers pooled as if each came from another person, ties "
        "dropped; not a valid test of these answers.",
        groups=(("", 2), ("nobody excluded", 1), ("further tests, p", 3), ("as published, p", 2)),
        header=(
            *("question", group.heading, f"win share, {LEVEL:.0%} interval"),
            *("sign", "Wilcoxon", "min F′", "binomial", "Wilcoxon"),
        ),
        rows=tuple(
            (
                *cells(wording.heading(row.question), row.label),
                counted(row.everyone.estimate, share_words(row.everyone, why=False)),
                *(
                    p_cell(p)
                    for p in (
                        row.robustness.sign_p,
                        row.robustness.wilcoxon_p,
                        row.robustness.min_f_p,
                        row.as_published.binomial_p,
                        row.as_published.wilcoxon_p,
                    )
                ),
            )
            for row in group.rows
        ),
        text_columns=2,
        notes=(f"As published leaves out of account {'; '.join(ignored)}.",) if ignored else (),
        name=name,
        data=data,
    )


def _sums(row: PreferenceRow) -> tuple[Cell, ...]:
    if not row.n:
        return cells("–", "–", "–", "0")
    one_strong, one_weak, equal, other_weak, other_strong = row.percentages
    one, other = one_strong + one_weak, other_strong + other_weak
    return (
        counted(one, wording.percent(one), best=one > other),
        counted(other, wording.percent(other), best=other > one),
        counted(equal, wording.percent(equal)),
        count_cell(row.n),
    )


def _headline(row: PreferenceRow) -> tuple[Cell, ...]:
    net = row.net
    return (
        *cells(wording.heading(row.question), row.label),
        counted(row.attentive, f"{row.attentive} of {row.recruited}"),
        count_cell(row.n),
        counted(row.win_share.estimate, share_words(row.win_share, why=False)),
        counted(net.estimate, plus_minus(net.estimate, net.standard_error)),
        p_cell(row.decision.p_value),
        p_cell(row.decision.p_holm),
    )


def _reasons(group: PreferenceGroup) -> tuple[str, ...]:
    """Return why numbers are missing or limited."""
    return gathered(
        (f"{wording.heading(row.question)}, {row.label}", note)
        for row in group.rows
        for note in (
            row.win_share.reason and f"no interval: {row.win_share.reason}",
            "" if row.win_share.method in {"", TWO_WAY} else f"interval {row.win_share.method}",
            row.win_share.remark,
            row.net.reason and f"no log-odds: {row.net.reason}",
            row.net.remark,
            row.decision.why and f"p is that of {INSTEAD[row.decision.by]}; {row.decision.why}",
        )
    )
