from __future__ import annotations

from pathlib import Path

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


def test_participants_who_fail_too_many_catch_trials_are_excluded(
    table: pd.DataFrame, tmp_path: Path
) -> None:
    failed = pd.concat(
        [table, catch_rows("p00", "lrl", (3, 5, 2)), catch_rows("p01", "lrl", (3, 2, 2))]
    )
    result = left_out(tmp_path, failed)
    assert set(result.exclusions) == {"p01"}
    assert (result.recruited, result.attentive) == (4, 3)
    assert set(result.analysed["participant"]) == {"p00", "p02", "p03"}
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
