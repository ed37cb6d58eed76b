import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.answers.exclusion_rules import KnownFacts, ParticipantFacts, SameAnswer
from analysis.answers.participants import LeftOut, facts_of, leave_out, quality, table_rules
from tests.analysis.results.made_tables import TABLES, catch_rows, pairwise_table, read_table

SECONDS = np.array([20.0, 30, 40, 20, 22, 24, 30, 30, np.nan, 2, 3, 30])


def answered(participants: str, **columns: object) -> pd.DataFrame:
    """Return analysed answers to one question."""
    people = pd.Categorical(list(participants))
    return pd.DataFrame({"participant": people, "value": 1.0, "seconds": math.nan, **columns})


def test_times_below_half_the_median_of_participants_are_too_fast() -> None:
    result = quality(answered("aaabbbcccddd", seconds=SECONDS)).response_seconds
    assert (result.low_quartile, result.median, result.high_quartile) == (17.25, 26, 30)
    assert (result.n, result.missing) == (11, 1)
    assert result.limit == 13
    assert result.too_fast == {"d": 3}
    nothing = quality(answered("a")).response_seconds
    assert (nothing.reason, nothing.missing, nothing.too_fast) == ("no response times", 1, {})


def test_who_answers_alike_is_listed_alone_and_in_order_of_appearance() -> None:
    answers = answered("qpoppoppopppppq", value=[2, 1, 1, 1, 1, 2, 1, 1, 1, 1, 2, 1, 1, 1, 2])
    assert [*quality(answers).straight_lining.participants.items()] == [("q", 1), ("p", 0.9)]


@pytest.fixture
def table() -> pd.DataFrame:
    return pairwise_table(("ours", "other"), effects=(0.5, 0.0), participants=3, segments=4)


def facts(
    folder: Path,
    table: pd.DataFrame,
    protocol: str = "pairwise",
    known: dict[str, KnownFacts] | None = None,
) -> dict[str, ParticipantFacts]:
    answers = read_table(table, protocol, folder)
    return {one.participant: one for one in facts_of(answers, known or {})}


def attention_rows(participant: str, answers: str, asked: str) -> pd.DataFrame:
    """One attention check a pair of digits: the answer, and what is asked for."""
    rows = catch_rows(participant, "l" * len(answers), [int(answer) for answer in answers])
    instructed = [int(answer) for answer in asked]
    return rows.drop(columns="correct_side").assign(kind="attention", instructed=instructed)


def test_any_answer_but_the_instructed_one_fails_an_attention_check_once(
    table: pd.DataFrame, tmp_path: Path
) -> None:
    checks = attention_rows("p01", "125", "224")
    again = attention_rows("p01", "125", "125").assign(question="rhythm")
    result = facts(tmp_path, pd.concat([table, checks, again]))
    assert result["p01"].failed_attention == 2


def test_attention_checks_are_never_analysed_and_noted_without_an_instructed_answer(
    table: pd.DataFrame, tmp_path: Path
) -> None:
    checks = attention_rows("p01", "12", "22")
    answers = read_table(pd.concat([table, checks]), "pairwise", tmp_path)
    assert set(answers.shown["kind"]) == {"practice", "main", "repeat"}
    assert not answers.notes
    checks = checks.drop(columns="instructed")
    assert read_table(pd.concat([table, checks]), "pairwise", tmp_path).notes == (
        "2 rows are left out (attention checks): the table does not say what they ask for, so "
        "they exclude nobody by themselves.",
    )


def test_several_rankings_may_be_told_to_put_one_condition_first(tmp_path: Path) -> None:
    ranking = TABLES["ranking"](participants=2, segments=3)
    own = ranking[(ranking["participant"] == "p00") & (ranking["segment"] == "s0")]
    first = np.where(own["condition"] == "static", 1.0, np.nan)
    checks = own.assign(kind="attention", instructed=first)
    obeyed = checks.assign(rank=[2, 3, 1])
    result = facts(tmp_path, pd.concat([ranking, checks.assign(rank=[1, 2, 3]), obeyed]), "ranking")
    assert (result["p00"].failed_attention, result["p01"].failed_attention) == (1, 0)
    # Ranks exclude one another: they are never alike.
    assert result["p01"].same_answers is None


def test_watching_and_times_cover_analysed_answers_only(
    table: pd.DataFrame, tmp_path: Path
) -> None:
    counts = table["kind"].isin(["main", "repeat"])
    timed = table.assign(
        watched=np.where(counts, 0.75, 0.0), response_seconds=np.where(counts, 4.0, 0.1)
    )
    timed.loc[timed.index[-1], "response_seconds"] = 2.5
    timed.loc[timed["participant"] == "p00", "response_seconds"] = np.nan
    result = facts(tmp_path, timed)
    assert result["p01"].watched == pytest.approx(0.75)
    assert result["p02"].seconds.tolist() == [2.5, 4.0, 4.0, 4.0]
    assert len(result["p00"].seconds) == 0


def test_straight_lining_is_counted_per_question_in_page_terms(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "other"), ("a", "b"), participants=1, effects=(0.5, 0))
    table["response"] = np.where(table["question"] == "a", 1, table["response"])
    [result] = facts(tmp_path, table).values()
    assert result.same_answers is not None
    assert result.same_answers[0] == SameAnswer(question="a", answers=6, share=1.0)
    assert result.same_answers[1].share < 1


def test_a_studys_own_judgement_replaces_the_tables(table: pd.DataFrame, tmp_path: Path) -> None:
    known = KnownFacts(trials=30, settled=12, failed_catch=0, failed_attention=2)
    both = pd.concat([table, catch_rows("p01", "ll", (5, 5))])
    result = facts(tmp_path, both, known={"p01": known})
    one = result["p01"]
    assert (one.trials, one.settled, one.failed_catch, one.failed_attention) == (30, 12, 0, 2)
    other = result["p02"]
    assert (other.trials, other.settled, other.failed_attention) == (None, None, None)
    assert math.isnan(other.watched)
    assert len(other.seconds) == 0


def left_out(folder: Path, table: pd.DataFrame, allowed: int = 1) -> LeftOut:
    answers = read_table(table, "pairwise", folder)
    return leave_out(answers, table_rules(answers, allowed))


def test_participants_who_fail_too_many_catch_trials_are_excluded(
    table: pd.DataFrame, tmp_path: Path
) -> None:
    failed = pd.concat(
        [table, catch_rows("p00", "lrl", (3, 5, 2)), catch_rows("p01", "lrl", (3, 2, 2))]
    )
    result = left_out(tmp_path, failed)
    assert set(result.exclusions) == {"p01"}
    assert (result.recruited, result.attentive) == (3, 2)
    # Who was shown no catch trial failed none.
    assert not result.rules[0].remark
    assert set(result.analysed["participant"]) == {"p00", "p02"}
    assert "p01" in set(result.everyone["participant"])
    assert set(result.analysed["kind"]) == {"main", "repeat"}


@pytest.mark.parametrize("sides", ["lr", "ll"])
@pytest.mark.parametrize("numbered", [True, False])
def test_a_catch_trial_counts_once_for_all_its_questions(
    sides: str, numbered: bool, table: pd.DataFrame, tmp_path: Path
) -> None:
    catch = catch_rows("p01", sides, (3, 3))
    both = pd.concat([table, catch, catch.assign(question="rhythm")])
    both = both if numbered else both.drop(columns="trial")
    assert left_out(tmp_path, both).exclusions == {"p01": "2 catch trials failed"}
    assert not left_out(tmp_path, both, 2).exclusions
