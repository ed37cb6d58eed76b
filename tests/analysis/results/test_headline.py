from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from analysis.answers.participants import LeftOut, leave_out, table_rules
from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS, AnswerTable
from analysis.results.agreement import agreed_so_far
from analysis.results.headline import headline_numbers
from analysis.results.report import analyse_table
from tests.analysis.results.made_tables import TABLES

PROTOCOLS = sorted(TABLES)


def given(protocol: str, folder: Path, table: pd.DataFrame) -> tuple[AnswerTable, LeftOut]:
    path = folder / "answers.csv"
    table.to_csv(path, index=False)
    answers = read_answers(path, LAYOUTS[protocol])
    return answers, leave_out(answers, table_rules(answers))


def reported(protocol: str, folder: Path) -> Any:
    return analyse_table(folder / "answers.csv", protocol).results


def headline(protocol: str, results: Any) -> list[tuple[object, ...]]:
    """Return the report's own numbers: of whom, estimate, interval, answers."""
    if protocol == "pairwise":
        shares = [(one.a, one.b, one.win_share) for one in results.comparisons]
    elif protocol == "mismatch":
        shares = [(one.condition, "", one.win_share) for one in results.conditions]
    elif protocol == "ranking":
        shares = [(one.condition, "", one.mean_rank) for one in results.conditions]
    else:
        shares = [(one.condition, "", one) for one in results.conditions]
    return [(a, b, one.estimate, one.low, one.high, one.n) for a, b, one in shares]


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_numbers_so_far_are_those_of_the_report(protocol: str, tmp_path: Path) -> None:
    table, left_out = given(protocol, tmp_path, TABLES[protocol]())
    results = reported(protocol, tmp_path)

    numbers = headline_numbers(table, left_out.analysed)
    [agreed] = agreed_so_far(table, left_out)

    assert [(one.a, one.b, one.estimate, one.low, one.high, one.n) for one in numbers] == headline(
        protocol, results
    )
    if protocol == "ranking":
        [whole] = results.kendall_w.found.values()
        assert (agreed.estimate, agreed.low, agreed.high) == (whole.estimate, whole.low, whole.high)
        assert (agreed.n, agreed.participants, agreed.retest) == (72, 12, None)
        return
    [whole], [again] = results.agreement.found.values(), results.test_retest.found.values()
    assert (agreed.estimate, agreed.low, agreed.high) == (whole.estimate, whole.low, whole.high)
    assert agreed.retest is not None
    assert repr(agreed.retest) == repr(again)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_agreement_does_not_tell_which_way_people_answer(protocol: str, tmp_path: Path) -> None:
    table = TABLES[protocol]()
    column = "rank" if protocol == "ranking" else "response"
    opposite = table.assign(**{column: table[column].max() + 1 - table[column]})

    [one] = agreed_so_far(*given(protocol, tmp_path, table))
    [other] = agreed_so_far(*given(protocol, tmp_path, opposite))

    numbers = ("estimate", "low", "high", "n", "participants")
    assert [getattr(other, name) for name in numbers] == pytest.approx(
        [getattr(one, name) for name in numbers]
    )
    assert str(replace(one, estimate=0, low=0, high=0, retest=None)) == str(
        replace(other, estimate=0, low=0, high=0, retest=None)
    )


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_too_few_answers_give_no_interval_and_say_why(protocol: str, tmp_path: Path) -> None:
    alone = TABLES[protocol](participants=1)

    table, left_out = given(protocol, tmp_path, alone)

    assert all(
        one.reason == "one participant" for one in headline_numbers(table, left_out.analysed)
    )
    [agreed] = agreed_so_far(table, left_out)
    assert agreed.estimate != agreed.estimate and agreed.reason


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_without_anybody_who_is_analysed_there_is_nothing(protocol: str, tmp_path: Path) -> None:
    table, left_out = given(protocol, tmp_path, TABLES[protocol](participants=2))
    nobody = replace(left_out, kept=left_out.kept.iloc[:0], analysed=left_out.analysed.iloc[:0])

    assert agreed_so_far(table, nobody) == ()
    assert headline_numbers(table, nobody.analysed) == ()
