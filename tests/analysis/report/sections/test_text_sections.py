from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.answers.exclusion_rules import watched_less
from analysis.report.content import Section, Still
from analysis.report.sections.answer import answer, certainty, limits_section, methods_section
from analysis.report.sections.heterogeneity import effects
from analysis.report.sections.participants import (
    diagnostics_section,
    flow_section,
    looks_section,
    sensitivity_section,
    stills_section,
    truth_section,
)
from analysis.results.known_values import KnownValue, match_values
from analysis.results.pairwise import PairwiseResults
from analysis.stats.multiple_testing import looks_before
from tests.analysis.looks import looked
from tests.analysis.report.sections.reading import present
from tests.analysis.report.subjects import SEGMENT, bare_subject, subject_of
from tests.analysis.results.made_tables import TABLES, catch_rows, pairwise_table, report_of

SENTENCE = "Results were looked at 2 times before these answers were complete, at 2 and 4 finished"


def words(section: Section | None) -> str:
    section = present(section)
    tables = [
        text
        for table in section.tables
        for text in (table.caption, *table.header, *(c.text for row in table.rows for c in row))
    ]
    return " ".join((section.heading, *section.paragraphs, *section.bullets, *tables))


def test_the_methods_text_says_what_was_done_and_with_what(tmp_path: Path) -> None:
    table = pd.concat([pairwise_table(participants=6), catch_rows("p00", "ll", (5, 5))])
    report = report_of(table, "pairwise", tmp_path, margin=0.1)

    text = words(methods_section(report, subject_of(report, notes=("A note.",), frozen=("face",))))

    for part in (
        "Of 6 participants who answered, 5 were analysed. Practice trials were dropped; those that",
        "failed more than 1 catch trial (1)",
        "Holm's method over 3 tests",
        "a win share is less than 0.1 away from one half",
        "The videos kept face still.",
        "1 segment of speech was used (1 speaker, 1 emotion, 4.00 s in all).",
        "Which fits [emotion] better?",
        "study with SHA-256 abc, seed 7",
        report.source.sha256,
        "A note.",
    ):
        assert part in text


@pytest.mark.parametrize("protocol", TABLES)
def test_every_protocol_has_its_method_its_diagnostics_and_its_limits(
    protocol: str, tmp_path: Path
) -> None:
    report = report_of(TABLES[protocol](participants=5, segments=4), protocol, tmp_path)
    subject = subject_of(report)

    texts = [
        words(section(report, subject))
        for section in (methods_section, diagnostics_section, limits_section, flow_section)
    ]

    assert "{" not in " ".join(texts)
    assert ("Practice trials" in texts[0]) == (protocol == "pairwise")

    assert "nan" not in " ".join(texts).split()
    assert (
        "Kendall's W (1 if all rank alike" if protocol == "ranking" else "Krippendorff's α"
    ) in texts[1]
    assert ("Side bias" in texts[1]) == (protocol in ("pairwise", "mismatch"))
    assert "One speaker says nothing about other speakers." in texts[2]
    limits = words(limits_section(replace(report, segments=1), subject))
    assert "Speech: one segment; the intervals apply to further participants, and to no" in limits


def test_a_rehearsals_truth_is_compared_with_estimates_in_either_direction(tmp_path: Path) -> None:
    report = report_of(pairwise_table(("ours", "other"), effects=(1.0, 0.0)), "pairwise", tmp_path)
    share = report.results.comparisons[0].win_share  # type: ignore[union-attr]
    known = KnownValue(
        about="ours-other",
        question="emotion",
        measure="win_share",
        value=share.estimate,
        on_these_segments=share.estimate,
    )
    turned = replace(known, about="other-ours", value=share.estimate - 0.9)

    pairs = match_values([report], (known, turned))
    section = present(truth_section(subject_of(report, origin="rehearsal", truth=pairs)))

    [first, second] = [[cell.text for cell in row] for row in section.tables[0].rows]
    assert first[6] == "inside"
    assert second[6] == "outside"
    assert float(second[4]) == pytest.approx(1 - share.estimate, abs=0.005)
    assert "1 of 2 intervals contain their true value" in section.paragraphs[0]
    assert truth_section(subject_of(report)) is None


def test_looks_are_reported_on_the_first_screen_in_the_methods_and_in_a_section(
    tmp_path: Path,
) -> None:
    report = report_of(pairwise_table(participants=6), "pairwise", tmp_path)
    before = looks_before([looked(2), looked(4, "")], finished=6, answers=60)
    seen = replace(report, looks=before)

    section = present(looks_section(seen))

    assert section.paragraphs[0].startswith(SENTENCE)
    assert (
        f"a false positive rate of {100 * before.false_positive_rate:.1f}% instead of 5%"
        in (section.paragraphs[1])
    )
    [table] = section.tables
    assert [[cell.text for cell in row] for row in table.rows] == [
        ["2026-05-04", "researcher 1", "researchers' page", "a video broke", "2", "30", "1"],
        ["2026-05-04", "researcher 1", "researchers' page", "not stated", "4", "30", "1"],
    ]
    subject = subject_of(seen)
    assert answer(seen, subject)[-1].startswith(SENTENCE)
    assert SENTENCE in " ".join(methods_section(seen, subject).paragraphs)
    looks = looks_before([looked(number) for number in range(1, 8)], finished=99, answers=990)
    busy = present(looks_section(replace(report, looks=looks)))
    assert "7 numbers of finished participants from 1 to 7" in busy.paragraphs[0]
    assert looks_section(report) is None
    assert "looked at" not in " ".join((*answer(report, subject), *certainty(report, subject)))


def stills(*conditions: str, **settings: Any) -> Section | None:
    shown = tuple(
        Still(condition=name, segment="s1", seconds=seconds, image="data:image/webp;x")
        for name in conditions
        for seconds in (0.4, 1.25)
    )
    excerpts = {"s1": replace(SEGMENT, transcript="Put them into <detention>.")}
    both = {"protocol": "rating", "conditions": ("ours", "theirs")}
    return stills_section(bare_subject(**both, excerpts=excerpts, stills=shown, **settings))


def test_each_condition_is_a_row_of_stills_or_named_with_a_reason() -> None:
    section = present(stills("ours", "<b>theirs</b>"))
    (strip,) = section.pictures
    assert strip.svg.count("<img ") == 4
    for part in ('alt="ours after 1.2 seconds"', '<th scope="col">0.4 s</th>'):
        assert part in strip.svg
    assert "<b>" not in strip.svg
    assert "“Put them into <detention>.”" in section.paragraphs[0]
    of_ours = present(stills("ours"))
    assert of_ours.paragraphs[1] == "There is no readable video of this segment for theirs."
    assert present(stills(no_stills="No videos.")).paragraphs == ("No videos.",)
    assert stills() is None


@pytest.mark.parametrize("protocol", ["pairwise", "ranking"])
def test_numbers_with_and_without_exclusions_stand_side_by_side(
    tmp_path: Path, protocol: str
) -> None:
    table = TABLES[protocol](participants=5, segments=4)
    left_out = table["participant"] == "p01"
    table["watched"] = np.where(left_out, 0.5, 1)
    exploratory, planned, nobody = (
        sensitivity_section(report, subject_of(report))
        for report in (
            report_of(table, protocol, tmp_path, exclude=[watched_less(0.9)]),
            report_of(table.assign(excluded=left_out), protocol, tmp_path),
            report_of(table, protocol, tmp_path, exclude=[watched_less(0.1)]),
        )
    )
    assert nobody is None
    (table_of_three,), (table_of_two,) = present(exploratory).tables, present(planned).tables
    assert [name for name, _ in table_of_two.groups[1:]] == ["analysed", "nobody excluded"]
    groups = ["analysed", "as planned", "nobody excluded"]
    assert [name for name, _ in table_of_three.groups[1:]] == groups
    for row in table_of_three.rows:
        assert len(row) == len(table_of_three.header)
        assert [row[place].text for place in (2, 4, 6)] == ["4", "5", "5"]
        assert row[4:6] == row[6:8]


@pytest.mark.parametrize("reference", ["ours", "other"])
def test_pairs_are_oriented_to_the_reference_as_in_the_headline(
    tmp_path: Path, reference: str
) -> None:
    table = pairwise_table(("ours", "other"), effects=(1.0, 0.0), participants=8)
    table["excluded"] = table["participant"] == table["participant"].iloc[0]
    report = report_of(table, "pairwise", tmp_path)
    assert isinstance(report.results, PairwiseResults)
    [comparison] = report.results.comparisons
    estimate = comparison.win_share.estimate
    toward = pytest.approx(estimate if comparison.a == reference else 1 - estimate)

    found = present(sensitivity_section(report, subject_of(report, reference=reference)))
    (effect,) = effects(report.results, reference)

    [[_, pair, _, share, *_]] = found.tables[0].rows
    assert pair.text.startswith(reference)
    assert share.value == toward
    assert effect.label.startswith(f"{reference} against")
    levels = effect.result.levels
    assert np.average([x.estimate for x in levels], weights=[x.n for x in levels]) == toward
