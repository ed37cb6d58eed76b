from __future__ import annotations

from pathlib import Path

import pandas as pd
import pytest

from analysis.results.ranking import RankingResults
from tests.analysis.results.made_tables import ranking_table, report_of


def results(folder: Path, table: pd.DataFrame) -> RankingResults:
    found = report_of(table, "ranking", folder).results
    assert isinstance(found, RankingResults)
    return found


def test_ranks_are_summarised_and_worths_follow_the_truth(tmp_path: Path) -> None:
    table = ranking_table(participants=15)
    found = results(tmp_path, table)
    by_name = {one.condition: one for one in found.conditions}
    expected = table.groupby("condition")["rank"]
    for name, one in by_name.items():
        assert one.mean_rank.estimate == pytest.approx(expected.mean()[name])
        assert one.first_share.estimate == pytest.approx((expected.get_group(name) == 1).mean())
        assert one.rank_percent[1] == pytest.approx(100 * one.first_share.estimate)
        assert sum(one.rank_percent.values()) == pytest.approx(100)
        assert one.mean_rank.low < one.mean_rank.estimate < one.mean_rank.high
    fitted = found.plackett_luce.of_set(None)["realism"]
    worths = {one.condition: one.estimate for one in fitted.conditions}
    assert sum(worths.values()) == pytest.approx(0, abs=1e-9)
    assert worths["truth"] > worths["ours"] > worths["static"]
    agreed = found.kendall_w.of_set(None)["realism"]
    assert 0 < agreed.estimate <= 1
    assert len(agreed.segments) == 6


def test_an_empty_rank_leaves_a_condition_out_of_its_ranking(tmp_path: Path) -> None:
    table = ranking_table()
    some = (
        table["rank"]
        .astype("Float64")
        .mask((table["condition"] == "static") & (table["segment"] == "s1"))
    )
    found = results(tmp_path, table.assign(rank=some))
    by_name = {one.condition: one for one in found.conditions}
    assert by_name["truth"].n == 12 * 6
    assert by_name["static"].n == 12 * 5
    assert by_name["truth"].remark == "12 of 72 rankings leave conditions out"


def test_every_two_conditions_are_compared_after_friedman(tmp_path: Path) -> None:
    found = results(tmp_path, ranking_table(participants=15))

    assert [(one.a, one.b) for one in found.posthoc] == [
        ("truth", "ours"),
        ("truth", "static"),
        ("ours", "static"),
    ]
    for one in found.posthoc:
        assert one.difference < 0
        assert one.conover_holm >= one.conover_p
        assert 0 <= one.nemenyi_p <= 1


def test_the_segments_that_were_ranked_are_a_sample_too(tmp_path: Path) -> None:
    found = results(tmp_path, ranking_table(participants=15))

    fitted = found.plackett_luce.of_set(None)["realism"]
    for one in fitted.conditions:
        assert one.low < one.estimate < one.high
    assert "4.96 degrees of freedom" in fitted.method
    agreed = found.kendall_w.of_set(None)["realism"]
    assert agreed.low < agreed.estimate < agreed.high
