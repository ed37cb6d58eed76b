from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.results.conditions import RankingResults
from tests.analysis.results.made_tables import ranking_table, report_of


def results(folder: Path, table: pd.DataFrame) -> RankingResults:
    found = report_of(table, "ranking", folder).results
    assert isinstance(found, RankingResults)
    return found


def test_worths_and_ranks_follow_the_truth_with_segments_as_a_sample(
    tmp_path: Path,
) -> None:
    found = results(tmp_path, ranking_table(participants=15))
    fitted = found.plackett_luce.of_set(None)["realism"]
    worths = {condition.condition: condition.estimate for condition in fitted.conditions}
    assert sum(worths.values()) == pytest.approx(0, abs=1e-9)
    assert worths["truth"] > worths["ours"] > worths["static"]
    for condition in fitted.conditions:
        assert condition.low < condition.estimate < condition.high
    assert "4.96 degrees of freedom" in fitted.method
    agreed = found.kendall_w.of_set(None)["realism"]
    assert 0 < agreed.low < agreed.estimate < agreed.high <= 1
    assert len(agreed.segments) == 6
    assert [(pair.a, pair.b) for pair in found.posthoc] == [
        ("truth", "ours"),
        ("truth", "static"),
        ("ours", "static"),
    ]
    assert all(pair.difference < 0 for pair in found.posthoc)


def test_an_empty_rank_leaves_a_condition_out_of_its_ranking(tmp_path: Path) -> None:
    table = ranking_table()
    some = (
        table["rank"]
        .astype("Float64")
        .mask((table["condition"] == "static") & (table["segment"] == "s1"))
    )
    found = results(tmp_path, table.assign(rank=some))
    by_name = {condition.condition: condition for condition in found.conditions}
    assert by_name["truth"].n == 12 * 6
    assert by_name["static"].n == 12 * 5
    assert by_name["truth"].remark == "12 of 72 rankings leave conditions out"
