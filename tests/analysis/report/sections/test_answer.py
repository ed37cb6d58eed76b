from dataclasses import replace
from pathlib import Path
from typing import Any

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


def test_a_preference_is_stated_with_the_deciding_estimate_and_its_sample(tmp_path: Path) -> None:
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


def all_prefer(table: pd.DataFrame, condition: str) -> pd.DataFrame:
    return table.assign(response=(table["left"] == condition).map({True: 1, False: 5}))


def in_opposite_halves() -> pd.DataFrame:
    """One of two participants always prefers a, the other b."""
    table = pairwise_table(("a", "b"), effects=(0.0, 0.0), participants=2)
    is_a = (table["left"] == "a") == (table["participant"] == "p00")
    return table.assign(response=is_a.map({True: 1, False: 5}))


def with_a_busy_participant() -> pd.DataFrame:
    table = pairwise_table(("ours", "other"), effects=(0.5, 0.0), participants=12, segments=12)
    busy = pd.concat([table[table["participant"] == "p00"]] * 9)
    return pd.concat([table, busy.assign(trial=range(1000, 1000 + len(busy)))])


TWINS = pairwise_table(("ours", "twin"), effects=(0.0, 0.0), participants=40, segments=20)
AGREED = all_prefer(pairwise_table(("a", "b"), ("x", "y"), participants=9, effects=(0, 0)), "a")
TIED = pairwise_table(("a", "b"), ("emotion", "rhythm"), effects=(0.0, 0.0), participants=20)
TIED["response"] = TIED["response"].where(TIED["question"] == "emotion", 3)
ONE_OF_TWO = "; 1 of the other 2 tests is also significant."


def of_three(*effects: float) -> pd.DataFrame:
    return pairwise_table(("a", "b", "c"), effects=effects, participants=20, segments=8)


@pytest.mark.parametrize(
    ("table", "settings", "answer_words", "certainty_words"),
    [
        # Undecided comparisons are not called equal unless a margin was stated.
        (TWINS, {}, "The test is not significant", "no evidence that two conditions are equally"),
        (TWINS, {"margin": 0.2}, "; equivalent within 0.2: twin and ours on emotion.", ""),
        # If everybody agrees, the sign test decides.
        (
            AGREED[(AGREED["question"] == "x") | (AGREED["participant"] != "p00")],
            {},
            "Participants preferred a to b on x (share of ",
            "tests use the exact sign test, because the usual test cannot be used",
        ),
        # The first sentence names the largest effect and counts the others.
        (of_three(3.0, 3.0, 0.0), {}, ONE_OF_TWO, "Also preferred: "),
        (of_three(0.0, 0.0, 3.0), {}, ONE_OF_TWO, "Also preferred: "),
        (of_three(4.0, 0, -4.0), {}, "; all of the other 2 tests are also", "Also preferred: "),
        # Only the tests of the family that could be run are counted.
        (
            pairwise_table("abcdef", effects=(3.0, 0, 0, 0, 0, 0), participants=20, segments=10),
            {"family": "against=b"},
            "; none of the other 4 tests is significant.",
            "4 of 5 tests are not significant",
        ),
        (TIED, {}, "The only test that could be run is not significant", "1 test could not be run"),
        (in_opposite_halves(), {}, "after Holm's correction).", ""),
        (
            with_a_busy_participant(),
            {},
            "",
            "Some participants gave far more answers than others. ",
        ),
        # Each protocol is answered by its own measure.
        (
            rating_table(participants=16, segments=10),
            {},
            "preferred truth to static on match (mean difference ",
            "",
        ),
        (
            ranking_table(participants=16, segments=10),
            {},
            "preferred truth to static on realism (difference of worths in logits ",
            "All conditions tested together: on realism (F(2, ",
        ),
        (
            mismatch_table(participants=40, segments=12),
            {},
            "truth with its own speech to truth with another's speech on fits",
            "",
        ),
        (ranking_table(participants=4).assign(rank=1), {}, "No test could be run: every ", ""),
    ],
)
def test_the_answer_and_its_certainty_are_those_of_the_deciding_tests(
    table: pd.DataFrame,
    settings: dict[str, Any],
    answer_words: str,
    certainty_words: str,
    tmp_path: Path,
) -> None:
    columns = {"left": "pairwise", "rank": "ranking", "left_speech": "mismatch"}
    protocol = next((columns[name] for name in columns if name in table), "rating")
    report = report_of(table, protocol, tmp_path, **settings)
    subject = subject_of(report)

    effect, said = answer(report, subject)[0], " ".join(certainty(report, subject))

    assert answer_words in effect
    assert effect.count(" preferred ") <= 1
    assert said.count(certainty_words) == 1 or not certainty_words
    assert "Equivalent" not in said


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
    catch = [catch_rows("p00", "ll", (5, 5)), catch_rows("p01", "l", (1,))]
    table = pd.concat([pairwise_table(participants=6), *catch])
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
