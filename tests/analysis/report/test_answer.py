from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from analysis.report.answer import answer
from analysis.report.flow_words import flow_line
from analysis.results.flow import Flow
from tests.analysis.report.made_reports import report_of, subject_of
from tests.analysis.results.made_tables import (
    TABLES,
    catch_rows,
    mismatch_table,
    pairwise_table,
    ranking_table,
    rating_table,
)


def test_a_clear_preference_is_named_with_its_interval_and_what_it_rests_on(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "other"), effects=(3.0, 0.0), participants=14, segments=8)
    report = report_of(table, "pairwise", tmp_path)

    effect, basis, limits = answer(report, subject_of(report))

    share = f"{report.results.comparisons[0].win_share.estimate:.2f}"[1:]  # type: ignore[union-attr]
    assert effect.startswith(
        f"Participants preferred ours to other on emotion (win share {share}, 95% interval [."
    )
    assert "14 of 14 participants and 1 segment of 1 speaker; nobody was excluded" in basis
    assert limits.startswith("It does not show how other systems")


def test_the_better_condition_comes_first_whichever_the_table_names_first(tmp_path: Path) -> None:
    table = pairwise_table(("worse", "better"), effects=(0.0, 3.0), participants=14, segments=8)
    report = report_of(table, "pairwise", tmp_path)

    assert answer(report, subject_of(report))[0].startswith(
        "Participants preferred better to worse"
    )


def test_what_is_not_decided_is_not_called_equal(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=10, segments=8)
    report = report_of(table, "pairwise", tmp_path)

    effect, _, limits = answer(report, subject_of(report))

    assert effect.startswith("None of 1 test decides")
    assert "no evidence that two conditions are equally good" in limits


def test_what_is_equivalent_within_the_margin_is_named(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=40, segments=20)
    report = report_of(table, "pairwise", tmp_path, margin=0.2)

    _, basis, _ = answer(report, subject_of(report))

    assert basis.startswith("Equivalent within 0.2 are twin and ours on emotion.")


def test_where_everybody_agrees_the_difference_is_named_though_nothing_can_be_tested(
    tmp_path: Path,
) -> None:
    table = pairwise_table(("ours", "other"), participants=6, effects=(0.0, 0.0))
    table["response"] = (table["left"] == "ours").map({True: 1, False: 5})
    report = report_of(table, "pairwise", tmp_path)

    effect = answer(report, subject_of(report))[0]

    assert effect.startswith("No test could be made: ")
    assert "that of ours to other on emotion (win share 1.00" in effect


def test_ratings_are_answered_by_mean_differences(tmp_path: Path) -> None:
    report = report_of(rating_table(participants=16, segments=10), "rating", tmp_path)

    effect = answer(report, subject_of(report))[0]

    assert "preferred truth to static on match (mean difference " in effect


def test_rankings_are_answered_by_mean_ranks_and_the_ranks_that_are_open(tmp_path: Path) -> None:
    report = report_of(ranking_table(participants=16, segments=10), "ranking", tmp_path)

    effect = answer(report, subject_of(report))[0]

    assert "placed best, by mean rank, truth on realism (mean rank 1." in effect
    assert "its rank may be 1" in effect


def test_no_condition_is_called_best_where_all_share_one_rank(tmp_path: Path) -> None:
    report = report_of(ranking_table(participants=4).assign(rank=1), "ranking", tmp_path)

    assert "none before the others on realism" in answer(report, subject_of(report))[0]


def test_own_speech_is_named_against_anothers(tmp_path: Path) -> None:
    report = report_of(mismatch_table(participants=40, segments=12), "mismatch", tmp_path)

    effect = answer(report, subject_of(report))[0]

    assert "truth with its own speech to truth with another's speech on fits" in effect


def test_a_rehearsal_says_that_no_person_answered(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)

    effect, _, limits = answer(report, subject_of(report, origin="rehearsal"))

    assert "imulated raters" in effect + limits
    assert "It does not show what any person prefers" in limits


def test_a_study_with_open_places_says_how_many(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)
    flow = Flow(
        arm="", places=9, opened=5, withdrawn=1, earlier=0, completed=4, answered=4, removed=(),
        analysed=4,
    )  # fmt: skip
    unfinished = replace(report, flow=(flow,))

    assert "4 of 9 places are filled" in answer(unfinished, subject_of(report))[-1]
    assert "places" not in answer(unfinished, subject_of(report, origin="rehearsal"))[-1]


def test_excluded_participants_are_counted_in_answer_and_flow(tmp_path: Path) -> None:
    table = pd.concat(
        [
            pairwise_table(participants=6),
            catch_rows("p00", "ll", (5, 5)),
            catch_rows("p01", "l", (1,)),
        ]
    )
    report = report_of(table, "pairwise", tmp_path)

    assert "5 of 6 participants" in answer(report, subject_of(report))[1]
    assert "1 was excluded" in answer(report, subject_of(report))[1]
    assert flow_line(report, subject_of(report)) == (
        "Participants: 6 answered − 1 failed more than 1 catch trial = 5 analysed."
    )


@pytest.mark.parametrize("protocol", TABLES)
def test_nobody_and_nothing_are_said_in_a_sentence(protocol: str, tmp_path: Path) -> None:
    report = report_of(TABLES[protocol](participants=2).iloc[:0], protocol, tmp_path)

    assert answer(report, subject_of(report))[0].startswith("There are no answers")
    assert answer(report, subject_of(report, origin="none")) == (
        "No participant has answered yet, so this report says nothing about preference.",
    )
