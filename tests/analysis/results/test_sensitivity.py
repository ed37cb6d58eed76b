"""Headline numbers with and without exclusions are those that a report without the rules gives."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.answers.exclusion_rules import ExclusionRule, answered_too_fast, marked, watched_less
from analysis.answers.participants import leave_out
from analysis.answers.reading import read_answers
from analysis.answers.table import LAYOUTS
from analysis.results.headline import Sensitivity, sensitivity
from analysis.results.report import analyse_table
from tests.analysis.results.made_tables import TABLES, ranking_table

PLANNED = watched_less(0.9)
AFTERWARDS = answered_too_fast(3, 0.5).as_exploratory()


def with_flaws(table: pd.DataFrame) -> pd.DataFrame:
    """Let p01 watch too little and p02 answer too fast."""
    who = table["participant"]
    return table.assign(
        watched=np.where(who == "p01", 0.5, 1), response_seconds=np.where(who == "p02", 1.0, 9.0)
    )


def found(
    folder: Path, protocol: str, *rules: ExclusionRule, table: pd.DataFrame | None = None
) -> tuple[Sensitivity, ...]:
    path = folder / "answers.csv"
    made = TABLES[protocol](participants=6, segments=4) if table is None else table
    with_flaws(made).to_csv(path, index=False)
    answers = read_answers(path, LAYOUTS[protocol])
    return sensitivity(answers, leave_out(answers, rules))


def test_nothing_depends_on_exclusions_where_there_are_none(tmp_path: Path) -> None:
    assert found(tmp_path, "rating", marked()) == ()


@pytest.mark.parametrize("protocol", list(TABLES))
def test_every_headline_number_is_given_of_all_three_groups(tmp_path: Path, protocol: str) -> None:
    each = found(tmp_path, protocol, PLANNED, AFTERWARDS)
    assert each
    for one in each:
        assert not one.is_as_planned
        assert [g.participants for g in (one.analysed, one.as_planned, one.everyone)] == [4, 5, 6]
        assert one.analysed.low < one.analysed.estimate < one.analysed.high


def test_as_planned_is_what_is_analysed_where_no_rule_is_exploratory(tmp_path: Path) -> None:
    assert all(one.is_as_planned for one in found(tmp_path, "ranking", PLANNED))


@pytest.mark.parametrize(
    ("protocol", "numbers"),
    [
        ("pairwise", lambda results: [one.win_share.estimate for one in results.comparisons]),
        ("mismatch", lambda results: [one.win_share.estimate for one in results.conditions]),
        ("rating", lambda results: [one.estimate for one in results.conditions]),
        ("ranking", lambda results: [one.mean_rank.estimate for one in results.conditions]),
    ],
)
def test_they_are_the_numbers_of_reports_with_and_without_the_rule(
    tmp_path: Path, protocol: str, numbers: Callable[[Any], list[float]]
) -> None:
    each = found(tmp_path, protocol, PLANNED)
    table = tmp_path / "answers.csv"
    with_rule = analyse_table(table, protocol, exclude=[PLANNED])
    without = analyse_table(table, protocol)
    assert [one.analysed.estimate for one in each] == pytest.approx(numbers(with_rule.results))
    assert [one.everyone.estimate for one in each] == pytest.approx(numbers(without.results))
    assert without.sensitivity == ()
    assert len(with_rule.sensitivity) == len(each)


def test_a_condition_that_only_excluded_participants_met_has_a_reason(tmp_path: Path) -> None:
    table = ranking_table(participants=3, segments=3)
    only = table["participant"] == "p01"
    table = table[only | (table["condition"] != "static")]
    last = found(tmp_path, "ranking", PLANNED, table=table)[-1]
    assert last.conditions == ("static",)
    assert last.analysed.n == 0
    assert last.analysed.reason == "nobody who answered this is analysed"
    assert last.everyone.n == 3
