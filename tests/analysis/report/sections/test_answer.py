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
from tests.analysis.report.sections.reading import present
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
    """Return a table's answer in one sentence, and the remarks on its certainty."""

    def read(table: pd.DataFrame, protocol: str, **settings: float | str) -> tuple[str, str]:
        report = report_of(table, protocol, tmp_path, **settings)
        subject = subject_of(report)
        return answer(report, subject)[0], " ".join(certainty(report, subject))

    return read


def test_a_preference_is_stated_with_the_deciding_estimate_and_its_sample(
    tmp_path: Path,
) -> None:
    table = pairwise_table(("ours", "other"), effects=(3.0, 0.0), participants=14, segments=8)
    report = report_of(table, "pairwise", tmp_path)

    effect, basis, limits = answer(report, subject_of(report))

    share = f"{report.results.comparisons[0].win_share.estimate:.2f}"[1:]  # type: ignore[union-attr]
    assert effect.startswith(
        f"Participants preferred ours to other on emotion (win share {share}, 95% interval [."
    )
    assert "14 of 14 participants and 8 segments of 1 speaker; nobody was excluded" in basis
    assert limits.startswith("This says nothing about other systems")

    table = pairwise_table(("ours", "other"), effects=(1.0, 0.0), participants=20, segments=20)
    modelled = report_of(table, "pairwise", tmp_path)
    [comparison] = modelled.results.comparisons  # type: ignore[union-attr]
    assert comparison.decision.by == "clmm"
    log_odds = f"(log-odds {abs(comparison.clmm.estimate):.2f}, 95% interval ["
    assert log_odds in answer(modelled, subject_of(modelled))[0]


def test_undecided_comparisons_are_not_called_equal_unless_a_margin_was_stated(
    answered: Answered,
) -> None:
    table = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=40, segments=20)

    effect, certainty_words = answered(table, "pairwise")
    within, further = answered(table, "pairwise", margin=0.2)

    assert effect.startswith("The test is not significant")
    assert "no evidence that two conditions are equally good" in certainty_words
    assert within.endswith("; equivalent within 0.2: twin and ours on emotion.")
    assert "Equivalent" not in further


def test_if_everybody_agrees_the_sign_test_decides_and_is_mentioned_once(
    answered: Answered,
) -> None:
    table = pairwise_table(
        ("ours", "other"), ("emotion", "rhythm"), participants=9, effects=(0.0, 0.0)
    )
    table["response"] = (table["left"] == "ours").map({True: 1, False: 5})
    fewer = table[(table["question"] != "rhythm") | (table["participant"] != "p00")]
    effect, certainty_words = answered(fewer, "pairwise")

    assert effect.startswith("Participants preferred ours to other on emotion (share of ")
    replaced = "tests use the exact sign test, because the usual test cannot be used"
    assert certainty_words.count(replaced) == 1


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
        ("ranking", ranking_table(participants=4).assign(rank=1), "No test could be run: every "),
    ],
)
def test_each_protocol_is_answered_by_its_own_measure(
    answered: Answered, protocol: str, table: pd.DataFrame, words: str
) -> None:
    effect, certainty_words = answered(table, protocol)
    assert words in effect
    tested_together = "All conditions tested together: on realism (F(2, " in certainty_words
    assert tested_together == (words.startswith("preferred") and protocol == "ranking")


def test_an_interval_that_does_not_decide_is_explained(tmp_path: Path) -> None:
    table = pairwise_table(
        ("a", "b", "c", "d"), effects=(2.0, 0.5, 0.4, 0.0), participants=9, segments=6
    )
    report = report_of(table, "pairwise", tmp_path)
    assert isinstance(report.results, PairwiseResults)
    by_p = sorted(report.results.contrasts, key=lambda contrast: contrast.p_holm)
    undecided = [replace(contrast, low=-1.0, high=1.0, p_holm=0.9) for contrast in by_p[1:]]
    contrasts = (replace(by_p[0], p_holm=0.064), *undecided)
    seen = replace(report, results=replace(report.results, contrasts=contrasts))

    assert "(difference of strengths in logits " in answer(report, subject_of(report))[0]
    assert (
        "Intervals are not corrected for multiple tests: 1 of them does not contain "
        "“no difference”, although the corrected p is not significant."
    ) in certainty(seen, subject_of(report))


def test_a_dominant_participant_raises_a_warning(answered: Answered) -> None:
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
        ((4.0, 0.0, -4.0), "; all of the other 2 tests are also significant."),
    ],
)
def test_the_first_sentence_names_the_largest_effect_and_counts_the_others(
    answered: Answered, effects: tuple[float, ...], end: str
) -> None:
    table = pairwise_table(("a", "b", "c"), effects=effects, participants=20, segments=8)
    effect, certainty_words = answered(table, "pairwise")

    assert effect.endswith(end)
    assert effect.count(" preferred ") == 1
    assert certainty_words.startswith("Also preferred: ")


def test_only_the_tests_of_the_family_that_could_be_run_are_counted(answered: Answered) -> None:
    table = pairwise_table("abcdef", effects=(3.0, 0, 0, 0, 0, 0), participants=20, segments=10)
    effect, certainty_words = answered(table, "pairwise", family="against=b")
    assert effect.endswith("; none of the other 4 tests is significant.")
    assert "4 of 5 tests are not significant" in certainty_words

    ties = pairwise_table(("a", "b"), ("emotion", "rhythm"), effects=(0.0, 0.0), participants=20)
    ties["response"] = ties["response"].where(ties["question"] == "emotion", 3)
    effect, certainty_words = answered(ties, "pairwise")
    assert effect.startswith("The only test that could be run is not significant")
    assert "1 test could not be run" in certainty_words

    halves = pairwise_table(("a", "b"), effects=(0.0, 0.0), participants=2)
    is_a = (halves["left"] == "a") == (halves["participant"] == "p00")
    halves["response"] = is_a.map({True: 1, False: 5})
    assert answered(halves, "pairwise")[0].endswith("after Holm's correction).")


def test_open_places_unwatched_study_sessions_and_people_screened_out_are_counted(
    tmp_path: Path,
) -> None:
    report = report_of(pairwise_table(participants=4), "pairwise", tmp_path)
    flow = Flow(
        arm="", places=9, opened=7, withdrawn=1, earlier=0, unwatched=2, completed=4, answered=4,
        removed=(), analysed=4,
    )  # fmt: skip
    counts = {"eligibility": 3, "consent": 0, "comprehension": 1}
    unfinished = replace(report, flow=(flow,), screened_out=counts)
    subject = subject_of(report)

    assert "4 of 9 places are filled" in answer(unfinished, subject)[-1]
    assert flow_line(unfinished, subject) == (
        "Participants: 4 screened out, 7 started − 1 withdrew − 2 gave no answer = 4 answered"
        " − 0 excluded = 4 analysed."
    )
    section, finished = (present(flow_section(each, subject)) for each in (unfinished, report))
    assert section.paragraphs[0].startswith(
        "4 people were screened out before the trials: 3 by the questions about eligibility"
    )
    unwatched = "2 study sessions ended before the last trial"
    assert any(text.startswith(unwatched) for text in section.paragraphs)
    assert not any("ended before the last trial" in text for text in finished.paragraphs)
    assert "screened out" not in flow_line(report, subject)
    *_, limits = answer(unfinished, subject_of(report, origin="rehearsal"))
    assert "This says nothing about what people prefer" in limits
    assert "places" not in limits


def test_excluded_participants_are_counted_in_the_answer_and_the_flow_with_their_reasons(
    tmp_path: Path,
) -> None:
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
    flow, reasons = flow_section(report, subject_of(report)).tables  # type: ignore[union-attr]
    assert [cell.text for cell in flow.rows[0]] == ["all", "6", "1", "5"]
    assert [cell.text for cell in reasons.rows[0]] == ["p00", "2 catch trials failed"]


@pytest.mark.parametrize("protocol", TABLES)
def test_zero_counts_are_written_in_words(protocol: str, tmp_path: Path) -> None:
    report = report_of(TABLES[protocol](participants=2).iloc[:0], protocol, tmp_path)

    assert answer(report, subject_of(report))[0].startswith("There are no answers")
    assert answer(report, subject_of(report, origin="none")) == (
        "No participant has answered yet, so this report says nothing about preference.",
    )
