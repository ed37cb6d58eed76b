from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest

from analysis.answers.participants import Flow
from analysis.report.sections.answer import answer, certainty
from analysis.report.sections.participants import flow_line, flow_section
from analysis.results.pairwise import PairwiseResults
from tests.analysis.report.subjects import subject_of
from tests.analysis.results.made_tables import (
    TABLES,
    catch_rows,
    mismatch_table,
    pairwise_table,
    ranking_table,
    rating_table,
    report_of,
)

Answered = Callable[..., tuple[str, str]]


@pytest.fixture
def answered(tmp_path: Path) -> Answered:
    """Return what gives a table's answer in one sentence, and what is said of its certainty."""

    def read(table: pd.DataFrame, protocol: str, **settings: float) -> tuple[str, str]:
        report = report_of(table, protocol, tmp_path, **settings)
        subject = subject_of(report)
        return answer(report, subject)[0], " ".join(certainty(report, subject))

    return read


def test_a_clear_preference_is_named_with_its_interval_and_what_it_rests_on(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "other"), effects=(3.0, 0.0), participants=14, segments=8)
    report = report_of(table, "pairwise", tmp_path)

    effect, basis, limits = answer(report, subject_of(report))

    share = f"{report.results.comparisons[0].win_share.estimate:.2f}"[1:]  # type: ignore[union-attr]
    assert effect.startswith(
        f"Participants preferred ours to other on emotion (win share {share}, 95% interval [."
    )
    assert "14 of 14 participants and 1 segment of 1 speaker; nobody was excluded" in basis
    assert limits.startswith("This says nothing about other systems")


def test_what_is_not_decided_is_not_called_equal(answered: Answered) -> None:
    table = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=10, segments=8)
    effect, sure = answered(table, "pairwise")

    assert effect.startswith("The test is not significant")
    assert "no evidence that two conditions are equally good" in sure


def test_what_is_equivalent_within_the_margin_is_named(answered: Answered) -> None:
    table = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=40, segments=20)
    effect, _ = answered(table, "pairwise", margin=0.2)

    assert effect.endswith("; equivalent within 0.2: twin and ours on emotion.")


def test_where_everybody_agrees_the_sign_test_decides_and_the_answer_says_so(
    answered: Answered,
) -> None:
    table = pairwise_table(("ours", "other"), participants=6, effects=(0.0, 0.0))
    table["response"] = (table["left"] == "ours").map({True: 1, False: 5})
    effect, sure = answered(table, "pairwise")

    assert effect.startswith("Participants preferred ours to other on emotion (share of ")
    assert "1 test uses the share of participants, because the usual test cannot be used" in sure


def test_why_the_win_share_decides_is_said_once_however_many_answered_each_question(
    answered: Answered,
) -> None:
    table = pairwise_table(questions=("emotion", "rhythm"), participants=8)
    fewer = table[(table["question"] != "rhythm") | (table["participant"] != "p00")]
    basis = answered(fewer, "pairwise")[1]

    assert basis.count("because the usual test cannot be used") == 1


@pytest.mark.parametrize(
    ("protocol", "table", "words"),
    [
        (
            "rating",
            rating_table(participants=16, segments=10),
            "preferred truth to static on match (mean difference ",
        ),
        (
            "ranking",
            ranking_table(participants=16, segments=10),
            "preferred truth to static on realism (difference of worths in logits ",
        ),
        (
            "mismatch",
            mismatch_table(participants=40, segments=12),
            "truth with its own speech to truth with another's speech on fits",
        ),
        (
            "pairwise",
            pairwise_table(("worse", "better"), effects=(0.0, 3.0), participants=14, segments=8),
            "Participants preferred better to worse",
        ),
        ("ranking", ranking_table(participants=4).assign(rank=1), "No test could be run: every "),
    ],
)
def test_each_protocol_is_answered_by_its_own_measure(
    answered: Answered, protocol: str, table: pd.DataFrame, words: str
) -> None:
    assert words in answered(table, protocol)[0]


def test_the_omnibus_test_of_rankings_is_reported(answered: Answered) -> None:
    table = ranking_table(participants=16, segments=10)
    assert "All conditions tested together: on realism (F(2, " in answered(table, "ranking")[1]


def test_rankings_of_sets_that_were_never_compared_are_refused_with_both_named(
    tmp_path: Path,
) -> None:
    first = ranking_table(("a", "b"), participants=6)
    second = ranking_table(("c", "d"), participants=6, seed=2)
    report = report_of(
        pd.concat([first, second.assign(participant="q" + second["participant"])]),
        "ranking",
        tmp_path,
    )

    effect = answer(report, subject_of(report))[0]

    assert "never compared with one another, not even through others: a and b | c and d" in effect


def test_the_model_decides_with_its_own_estimate_quoted(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "other"), effects=(1.0, 0.0), participants=20, segments=20)
    report = report_of(table, "pairwise", tmp_path)

    effect = answer(report, subject_of(report))[0]

    [one] = report.results.comparisons  # type: ignore[union-attr]
    assert one.decision.by == "clmm"
    assert f"(log-odds {abs(one.clmm.estimate):.2f}, 95% interval [" in effect


def test_of_many_conditions_strengths_decide_and_an_interval_that_does_not_is_explained(
    tmp_path: Path,
) -> None:
    table = pairwise_table(
        ("a", "b", "c", "d"), effects=(2.0, 0.5, 0.4, 0.0), participants=9, segments=6
    )
    report = report_of(table, "pairwise", tmp_path)
    assert isinstance(report.results, PairwiseResults)
    first = next(one for one in report.results.contrasts if one.p_holm < 0.05)
    others = [
        replace(one, low=-1.0, high=1.0) if one.p_holm >= 0.05 else one
        for one in report.results.contrasts
        if one is not first
    ]
    open_one = replace(first, p_holm=0.064)
    seen = replace(report, results=replace(report.results, contrasts=(open_one, *others)))

    assert "(difference of strengths in logits " in answer(report, subject_of(report))[0]
    assert (
        "Intervals are not corrected for multiple tests: 1 of them excludes no difference, "
        "although p, corrected over 6 tests, is not significant."
    ) in certainty(seen, subject_of(report))


def test_a_very_busy_participant_is_warned_of(answered: Answered) -> None:
    table = pairwise_table(("ours", "other"), effects=(0.5, 0.0), participants=12, segments=12)
    busy = pd.concat([table[table["participant"] == "p00"]] * 9)
    table = pd.concat([table, busy.assign(trial=range(1000, 1000 + len(busy)))])
    basis = answered(table, "pairwise")[1]

    assert "Some participants gave far more answers than others. " in basis
    assert "without any one participant the estimate lies between 0." in basis


@pytest.mark.parametrize(
    ("effects", "end"),
    [
        ((3.0, 3.0, 0.0), "; 1 of the other 2 tests is also significant."),
        ((0.0, 0.0, 3.0), "; 1 of the other 2 tests is also significant."),
        ((4.0, 0.0, -4.0), "; 2 of the other 2 tests are also significant."),
    ],
)
def test_the_first_sentence_names_the_largest_and_counts_the_others(
    answered: Answered, effects: tuple[float, ...], end: str
) -> None:
    table = pairwise_table(("a", "b", "c"), effects=effects, participants=20, segments=8)
    effect, sure = answered(table, "pairwise")

    assert effect.endswith(end)
    assert effect.count(" preferred ") == 1
    assert sure.startswith("Also preferred: ")


def test_a_rehearsal_says_that_no_person_answered(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)

    effect, _, limits = answer(report, subject_of(report, origin="rehearsal"))

    assert "imulated raters" in effect + limits
    assert "This says nothing about what people prefer" in limits


def test_a_study_with_open_places_says_how_many(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)
    flow = Flow(
        arm="", places=9, opened=5, withdrawn=1, earlier=0, completed=4, answered=4, removed=(),
        analysed=4,
    )  # fmt: skip
    unfinished = replace(report, flow=(flow,))

    assert "4 of 9 places are filled" in answer(unfinished, subject_of(report))[-1]
    assert "places" not in answer(unfinished, subject_of(report, origin="rehearsal"))[-1]


def test_study_sessions_that_ended_unwatched_are_counted_among_the_participants(
    tmp_path: Path,
) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)
    flow = Flow(
        arm="", places=9, opened=7, withdrawn=0, earlier=0, unwatched=2, completed=4, answered=4,
        removed=(), analysed=4,
    )  # fmt: skip

    words, unflawed = (
        section.paragraphs
        for found in (replace(report, flow=(flow,)), report)
        if (section := flow_section(found, subject_of(found)))
    )

    assert any(text.startswith("2 study sessions ended before the last trial") for text in words)
    assert not any("ended before the last trial" in text for text in unflawed)


def test_those_who_were_screened_out_stand_before_those_who_started(tmp_path: Path) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)
    counts = {"eligibility": 3, "consent": 0, "comprehension": 1}
    screened = replace(report, screened_out=counts)

    section = flow_section(screened, subject_of(report))

    assert flow_line(screened, subject_of(report)).startswith("Participants: 4 screened out, ")
    assert section is not None
    assert section.paragraphs[0].startswith(
        "4 people were screened out before the trials: 3 by the questions about eligibility"
    )
    assert "screened out" not in flow_line(report, subject_of(report))


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
