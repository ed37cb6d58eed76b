from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.results.ranking import RankingResults
from tests.analysis.results.made_tables import ranking_table, report_of


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return ranking_table(participants=15)


@pytest.fixture(scope="module")
def found(table: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> RankingResults:
    results = report_of(table, "ranking", tmp_path_factory.mktemp("ranking")).results
    assert isinstance(results, RankingResults)
    return results


def test_ranks_are_summarised(table: pd.DataFrame, found: RankingResults) -> None:
    ranks = table.groupby("condition")["rank"]
    for one in found.conditions:
        assert one.mean_rank.estimate == pytest.approx(ranks.mean()[one.condition])
        first = (ranks.get_group(one.condition) == 1).mean()
        assert one.first_share.estimate == pytest.approx(first)
        assert one.rank_percent[1] == pytest.approx(100 * first)
        assert sum(one.rank_percent.values()) == pytest.approx(100)
        assert one.mean_rank.low < one.mean_rank.estimate < one.mean_rank.high


def test_worths_follow_the_truth_and_take_segments_for_a_sample(found: RankingResults) -> None:
    fitted = found.plackett_luce.of_set(None)["realism"]
    worths = {one.condition: one.estimate for one in fitted.conditions}
    assert sum(worths.values()) == pytest.approx(0, abs=1e-9)
    assert worths["truth"] > worths["ours"] > worths["static"]
    for one in fitted.conditions:
        assert one.low < one.estimate < one.high
    assert "4.96 degrees of freedom" in fitted.method
    agreed = found.kendall_w.of_set(None)["realism"]
    assert 0 < agreed.low < agreed.estimate < agreed.high <= 1
    assert len(agreed.segments) == 6


def test_an_empty_rank_leaves_a_condition_out_of_its_ranking(tmp_path: Path) -> None:
    table = ranking_table()
    some = (
        table["rank"]
        .astype("Float64")
        .mask((table["condition"] == "static") & (table["segment"] == "s1"))
    )
    found = report_of(table.assign(rank=some), "ranking", tmp_path).results
    assert isinstance(found, RankingResults)
    by_name = {one.condition: one for one in found.conditions}
    assert by_name["truth"].n == 12 * 6
    assert by_name["static"].n == 12 * 5
    assert by_name["truth"].remark == "12 of 72 rankings leave conditions out"


def test_every_two_conditions_are_compared_after_friedman(found: RankingResults) -> None:
    assert [(one.a, one.b) for one in found.posthoc] == [
        ("truth", "ours"),
        ("truth", "static"),
        ("ours", "static"),
    ]
    for one in found.posthoc:
        assert one.difference < 0
        assert one.conover_holm >= one.conover_p
        assert 0 <= one.nemenyi_p <= 1
