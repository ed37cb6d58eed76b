from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.answers.participants import LeftOut, leave_out, table_rules
from tests.analysis.results.made_tables import catch_rows, pairwise_table, read_table


@pytest.fixture
def table() -> pd.DataFrame:
    return pairwise_table(("ours", "other"), effects=(0.5, 0.0), participants=4, segments=3)


def left_out(folder: Path, table: pd.DataFrame, allowed: int = 1) -> LeftOut:
    answers = read_table(table, "pairwise", folder)
    return leave_out(answers, table_rules(answers, allowed))


@pytest.mark.parametrize(
    ("answers", "allowed", "excluded"),
    [
        ((1, 5, 2), 1, False),
        ((3, 5, 2), 1, False),
        ((3, 2, 2), 1, True),
        ((3, 2, 2), 2, False),
        ((3, 5, 2), 0, True),
    ],
)
def test_who_fails_more_catch_trials_than_allowed_is_left_out(
    answers: tuple[int, ...], allowed: int, excluded: bool, table: pd.DataFrame, tmp_path: Path
) -> None:
    both = pd.concat([table, catch_rows("p01", "lrl", answers)])
    result = left_out(tmp_path, both, allowed)
    assert set(result.exclusions) == ({"p01"} if excluded else set())
    assert (result.recruited, result.attentive) == (4, 3 if excluded else 4)
    assert ("p01" in set(result.analysed["participant"])) == (not excluded)
    assert "p01" in set(result.everyone["participant"])
    assert set(result.analysed["kind"]) == {"main", "repeat"}


@pytest.mark.parametrize("sides", ["lr", "ll"])
@pytest.mark.parametrize("numbered", [True, False])
def test_a_catch_trial_is_failed_once_whatever_questions_it_asks_and_may_come_again(
    sides: str, numbered: bool, table: pd.DataFrame, tmp_path: Path
) -> None:
    catch = catch_rows("p01", sides, (3, 3))
    both = pd.concat([table, catch, catch.assign(question="rhythm")])
    both = both if numbered else both.drop(columns="trial")
    assert left_out(tmp_path, both).exclusions == {"p01": "2 catch trials failed"}
    assert not left_out(tmp_path, both, 2).exclusions


def test_rules_apply_one_after_the_other(table: pd.DataFrame, tmp_path: Path) -> None:
    marked = table.assign(excluded=np.where(table["participant"] == "p01", "withdrew", ""))
    result = left_out(tmp_path, pd.concat([marked, catch_rows("p01", "ll", (5, 5))]))
    assert result.exclusions == {"p01": "withdrew"}
    assert [(rule.reached, rule.removed) for rule in result.rules] == [(4, 1), (3, 0)]
