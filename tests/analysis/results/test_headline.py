"""Headline numbers, interim and without exclusions, equal those of a report."""

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.answers.exclusion_rules import ExclusionRule, answered_too_fast, watched_less
from analysis.answers.participants import LeftOut, leave_out, table_rules
from analysis.answers.table import AnswerTable
from analysis.results.headline import Sensitivity, agreed_so_far, headline_numbers, sensitivity
from analysis.results.report import TableReport, analyse_table
from tests.analysis.results.made_tables import TABLES, ranking_table, read_table

PROTOCOLS = sorted(TABLES)
PLANNED = watched_less(0.9)
AFTERWARDS = answered_too_fast(3, 0.5).as_exploratory()


def given(
    protocol: str, folder: Path, table: pd.DataFrame, *rules: ExclusionRule
) -> tuple[AnswerTable, LeftOut]:
    answers = read_table(table, protocol, folder)
    return answers, leave_out(answers, rules or table_rules(answers))


def headline(report: TableReport) -> list[tuple[object, ...]]:
    """Return the report's own numbers: of whom, estimate, interval, answers."""
    results: Any = report.results
    field = {"ranking": "mean_rank", "rating": ""}.get(report.protocol, "win_share")
    rows = []
    for result in results.comparisons if report.protocol == "pairwise" else results.conditions:
        number = getattr(result, field) if field else result
        names = (*result.names, "")[:2]
        rows.append((*names, number.estimate, number.low, number.high, number.n))
    return rows


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_numbers_so_far_are_those_of_the_report(protocol: str, tmp_path: Path) -> None:
    table, left_out = given(protocol, tmp_path, TABLES[protocol]())
    report = analyse_table(tmp_path / "answers.csv", protocol)
    results: Any = report.results

    numbers = headline_numbers(table, left_out.analysed)
    [agreed] = agreed_so_far(table, left_out)

    fields = ("a", "b", "estimate", "low", "high", "n")
    assert [tuple(row[name] for name in fields) for row in numbers] == headline(report)
    is_ranking = protocol == "ranking"
    [whole] = (results.kendall_w if is_ranking else results.agreement).results.values()
    for name in ("estimate", "low", "high"):
        assert agreed[name] == getattr(whole, name)
    if is_ranking:
        assert (agreed["n"], agreed["participants"], agreed["retest"]) == (72, 12, None)
    else:
        assert repr([agreed["retest"]]) == repr([*results.test_retest.results.values()])


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_agreement_does_not_reveal_the_direction_of_answers(protocol: str, tmp_path: Path) -> None:
    table = TABLES[protocol]()
    column = "rank" if protocol == "ranking" else "response"
    opposite = table.assign(**{column: table[column].max() + 1 - table[column]})

    [one] = agreed_so_far(*given(protocol, tmp_path, table))
    [other] = agreed_so_far(*given(protocol, tmp_path, opposite))

    retests = one.pop("retest"), other.pop("retest")
    assert one == pytest.approx(other)
    assert (retests[0] is None) == (retests[1] is None)


def with_and_without(
    folder: Path, protocol: str, *rules: ExclusionRule, table: pd.DataFrame | None = None
) -> tuple[Sensitivity, ...]:
    """Return the numbers of a table where p01 watches too little and p02 answers too fast."""
    made = TABLES[protocol](participants=6, segments=4) if table is None else table
    people = made["participant"]
    flawed = made.assign(
        watched=np.where(people == "p01", 0.5, 1),
        response_seconds=np.where(people == "p02", 1.0, 9.0),
    )
    return sensitivity(*given(protocol, folder, flawed, *rules))


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_numbers_with_and_without_exclusions_match_such_reports(
    tmp_path: Path, protocol: str
) -> None:
    each = with_and_without(tmp_path, protocol, PLANNED, AFTERWARDS)
    rules = {"analysed": [PLANNED, AFTERWARDS], "as_planned": [PLANNED], "everyone": []}
    for (name, exclude), participants in zip(rules.items(), (4, 5, 6), strict=True):
        report = analyse_table(tmp_path / "answers.csv", protocol, exclude=exclude)
        estimates = [getattr(number, name) for number in each]
        assert {estimate.participants for estimate in estimates} == {participants}
        assert [estimate.estimate for estimate in estimates] == pytest.approx(
            [row[2] for row in headline(report)]
        )
        assert len(report.sensitivity) == (len(each) if exclude else 0)
    assert not any(number.is_as_planned for number in each)
    planned = with_and_without(tmp_path, protocol, PLANNED)
    assert all(number.is_as_planned for number in planned)


def test_a_condition_seen_only_by_excluded_participants_has_a_reason(tmp_path: Path) -> None:
    table = ranking_table(participants=3, segments=3)
    only = table["participant"] == "p01"
    table = table[only | (table["condition"] != "static")]
    last = with_and_without(tmp_path, "ranking", PLANNED, table=table)[-1]
    assert last.conditions == ("static",)
    assert last.analysed.n == 0
    assert last.analysed.reason == "nobody who answered this is analysed"
    assert last.everyone.n == 3
