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
    for condition in found.conditions:
        assert condition.mean_rank.estimate == pytest.approx(ranks.mean()[condition.condition])
        first = (ranks.get_group(condition.condition) == 1).mean()
        assert condition.first_share.estimate == pytest.approx(first)
        assert condition.rank_percent[1] == pytest.approx(100 * first)
        assert sum(condition.rank_percent.values()) == pytest.approx(100)
        assert condition.mean_rank.low < condition.mean_rank.estimate < condition.mean_rank.high


def test_worths_follow_the_truth_and_take_segments_for_a_sample(found: RankingResults) -> None:
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


def test_an_empty_rank_leaves_a_condition_out_of_its_ranking(tmp_path: Path) -> None:
    table = ranking_table()
    some = (
        table["rank"]
        .astype("Float64")
        .mask((table["condition"] == "static") & (table["segment"] == "s1"))
    )
    found = report_of(table.assign(rank=some), "ranking", tmp_path).results
    assert isinstance(found, RankingResults)
    by_name = {condition.condition: condition for condition in found.conditions}
    assert by_name["truth"].n == 12 * 6
    assert by_name["static"].n == 12 * 5
    assert by_name["truth"].remark == "12 of 72 rankings leave conditions out"


def test_every_two_conditions_are_compared_after_friedman(found: RankingResults) -> None:
    assert [(pair.a, pair.b) for pair in found.posthoc] == [
        ("truth", "ours"),
        ("truth", "static"),
        ("ours", "static"),
    ]
    for pair in found.posthoc:
        assert pair.difference < 0
        assert pair.conover_holm >= pair.conover_p
        assert 0 <= pair.nemenyi_p <= 1
