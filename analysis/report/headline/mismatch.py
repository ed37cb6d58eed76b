"""The same motion with its own and with other speech, and which one fits."""

from __future__ import annotations

from analysis.report.content import Section
from analysis.report.figures.preference_figure import preference_pictures
from analysis.report.headline.preference_rows import PreferenceGroup, mismatch_groups
from analysis.report.headline.preference_tables import (
    counts_table,
    further_table,
    sums_table,
    win_share_table,
)
from analysis.report.headline.words import in_set, suffix, why_no_figure
from analysis.report.subject import Subject
from analysis.results.mismatch import MismatchResults

_DATA = "conditions.csv"


def mismatch_sections(results: MismatchResults, subject: Subject) -> tuple[Section, ...]:
    """Return one section for each set."""
    groups = mismatch_groups(results)
    numbers = range(1, len(groups) + 1)
    return tuple(
        _section(group, subject.mark, suffix(None if group.set is None else number))
        for number, group in zip(numbers, groups, strict=True)
    )


def _section(group: PreferenceGroup, mark: str, end: str) -> Section:
    reason = why_no_figure(
        answers=sum(row.n for row in group.rows),
        participants=max(row.attentive for row in group.rows),
        tied=group.all_tied,
    )
    return Section(
        anchor=f"headline{end}",
        heading=in_set(group.set, "Whether the motion fits its own speech"),
        paragraphs=(
            reason
            or "A win share of .5 is what a condition gets whose motion fits any speech as well as "
            "its own; a higher one says that its motion belongs to what is said.",
        ),
        pictures=()
        if reason
        else preference_pictures(group, name=f"own-speech{end}", data=_DATA, mark=mark),
        tables=(
            win_share_table(group, name=f"win-shares{end}", data=_DATA),
            sums_table(group, name=f"own-speech{end}", data=_DATA),
            counts_table(group, name=f"counts{end}", data=_DATA),
            further_table(group, name=f"as-published{end}", data=_DATA),
        ),
    )
