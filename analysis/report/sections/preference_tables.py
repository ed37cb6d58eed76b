"""Preferences in tables: as AMUSE's Table A.5, in full, with intervals, and as published."""

from __future__ import annotations

from functools import partial
from types import MappingProxyType
from typing import Final

from analysis.report import wording
from analysis.report.content import (
    Cell,
    Column,
    Table,
    cells,
    count_cell,
    counted,
    p_cell,
    table_by_question,
    table_of,
)
from analysis.report.sections.preference_rows import PreferenceGroup, PreferenceRow, levels
from analysis.report.wording import (
    CLUSTERED,
    HOLM,
    INTERVAL,
    gathered,
    plus_minus,
    share_words,
)
from analysis.results.net_preference import NetPreference
from analysis.stats.clustered_mean import LEVEL, TWO_WAY, Estimate

INSTEAD: Final = MappingProxyType(
    {
        "clmm": "the mixed model",
        "win_share": "the win share",
        "sign": "the exact sign test of participants, who alone are taken as a sample",
    }
)
"""What a p value is one of."""


def sums_table(group: PreferenceGroup, *, name: str) -> Table:
    """Return the percentages for the one, for the other and for neither."""
    caption = (
        f"Preferences in the layout of AMUSE's Table A.5: clear and slight "
        f"preferences for {group.one} and for {group.other}, in % of the n answers after "
        "exclusions. That table leaves “no difference” out; here it stands beside. The larger "
        "share is bold, which is not a test."
    )
    return table_by_question(
        {(row.label, row.found.question): _sums(row) for row in group.rows},
        group.heading,
        (group.one, group.other, "no difference", "n"),
        caption=caption,
        name=name,
        data=group.data,
    )


def counts_table(group: PreferenceGroup) -> Table:
    """Return how many gave each of the five answers."""
    return table_of(
        group.rows,
        *_about(group),
        *(
            (words, partial(_count, level))
            for level, words in enumerate(levels(group.one, group.other))
        ),
        ("answers", lambda row: count_cell(row.found.n)),
        caption="Answers after exclusions: number, and % of the row.",
        notes=("Rounded percentages may not add up to 100.",),
        name="counts",
        data=group.data,
        secondary="Every answer, counted",
    )


def _about(group: PreferenceGroup) -> tuple[Column[PreferenceRow], ...]:
    return (
        ("question", lambda row: wording.heading(row.found.question)),
        (group.heading, lambda row: row.label),
    )


def _count(level: int, row: PreferenceRow) -> Cell:
    count, percent = row.levels[level], row.percentages[level]
    return counted(count, f"{count} ({percent:.0f})" if row.found.n else "–")


def win_share_table(group: PreferenceGroup) -> Table:
    """Return the headline numbers: win share with its interval, and the model's net preference."""
    return table_of(
        group.rows,
        *_about(group),
        (
            "participants",
            lambda row: counted(
                row.found.attentive, f"{row.found.attentive} of {row.found.recruited}"
            ),
        ),
        ("answers", lambda row: count_cell(row.found.n)),
        (f"win share, {INTERVAL}", lambda row: _share(row.found.win_share)),
        ("log-odds", lambda row: _log_odds(row.found.clmm)),
        ("p", lambda row: p_cell(row.found.decision.p_value)),
        (HOLM, lambda row: p_cell(row.found.decision.p_holm)),
        caption=f"Win share of {group.one}: preferences for it plus half of "
        "“no difference”, as a share of all answers, with its "
        f"{LEVEL:.0%} interval, clustered by participant and segment ({CLUSTERED}). Log-odds: "
        "net preference in a cumulative link mixed model with crossed effects of participants and "
        "segments; p by its likelihood ratio, or of what a note names in its place, corrected by "
        "Holm over the report's family of tests. After exclusions.",
        notes=(
            "Participants: those analysed, of those who took part in the comparison.",
            *_reasons(group),
        ),
        name="win-shares",
        data=group.data,
    )


def _share(found: Estimate) -> Cell:
    return counted(found.estimate, share_words(found, why=False))


def _log_odds(net: NetPreference) -> Cell:
    return counted(net.estimate, plus_minus(net.estimate, net.standard_error))


def further_table(group: PreferenceGroup) -> Table:
    """Return what stands beside the headline: without exclusions, by other tests, as published."""
    ignored = dict.fromkeys(words for row in group.rows for words in row.found.as_published.ignores)
    return table_of(
        group.rows,
        *_about(group),
        (f"win share, {INTERVAL}", lambda row: _share(row.found.without_exclusions.win_share)),
        ("sign", lambda row: p_cell(row.found.robustness.sign_p)),
        ("Wilcoxon", lambda row: p_cell(row.found.robustness.wilcoxon_p)),
        ("min F′", lambda row: p_cell(row.found.robustness.min_f_p)),
        ("binomial", lambda row: p_cell(row.found.as_published.binomial_p)),
        ("Wilcoxon", lambda row: p_cell(row.found.as_published.wilcoxon_p)),
        caption="Beside the headline. Nobody excluded: the win share over all "
        "who answered. Further tests: exact ones over participants' means, which take the "
        "segments as the only ones of interest, and min F′, which is conservative. As published: "
        "what papers report, all answers pooled as if each came from another person, ties "
        "dropped; not a valid test of these answers.",
        groups=(("", 2), ("nobody excluded", 1), ("further tests, p", 3), ("as published, p", 2)),
        notes=(f"As published leaves out of account {'; '.join(ignored)}.",) if ignored else (),
        name="as-published",
        data=group.data,
        secondary="Without exclusions, by further tests, and as papers report",
    )


def _sums(row: PreferenceRow) -> tuple[Cell, ...]:
    if not row.found.n:
        return cells("–", "–", "–", "0")
    one_strong, one_weak, equal, other_weak, other_strong = row.percentages
    one, other = one_strong + one_weak, other_strong + other_weak
    return (
        counted(one, wording.percent(one), best=one > other),
        counted(other, wording.percent(other), best=other > one),
        counted(equal, wording.percent(equal)),
        count_cell(row.found.n),
    )


def _reasons(group: PreferenceGroup) -> tuple[str, ...]:
    """Return why numbers are missing or limited."""
    return gathered(
        (f"{wording.heading(row.found.question)}, {row.label}", note)
        for row in group.rows
        for share, net, decision in ((row.found.win_share, row.found.clmm, row.found.decision),)
        for note in (
            share.reason and f"no interval: {share.reason}",
            "" if share.method in {"", TWO_WAY} else f"interval {share.method}",
            share.remark,
            net.reason and f"no log-odds: {net.reason}",
            net.remark,
            decision.why and f"p is that of {INSTEAD[decision.by]}; {decision.why}",
        )
    )
