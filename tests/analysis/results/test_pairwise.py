from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.holm import holm
from analysis.ordinal.mixed_model import RandomEffect, fit, likelihood_ratio
from analysis.preferences.clustered import clustered_mean
from analysis.results.pairwise import PairwiseResults
from analysis.results.report import TableReport, analyse_table
from tests.analysis.results.made_tables import catch_rows, pairwise_table


def analyse(folder: Path, table: pd.DataFrame, **options: Any) -> TableReport:
    path = folder / "answers.csv"
    table.to_csv(path, index=False)
    return analyse_table(path, "pairwise", **options)


def results(folder: Path, table: pd.DataFrame, **options: Any) -> PairwiseResults:
    found = analyse(folder, table, **options).results
    assert isinstance(found, PairwiseResults)
    return found


@pytest.fixture(scope="module")
def table() -> pd.DataFrame:
    return pairwise_table(questions=("emotion", "rhythm"), participants=8, segments=5)


@pytest.fixture(scope="module")
def found(table: pd.DataFrame, tmp_path_factory: pytest.TempPathFactory) -> PairwiseResults:
    return results(tmp_path_factory.mktemp("pairwise"), table, margin=0.45)


def test_a_comparison_agrees_with_its_parts(table: pd.DataFrame, found: PairwiseResults) -> None:
    assert [c.question for c in found.comparisons] == ["emotion", "rhythm"] * 3

    one = next(c for c in found.comparisons if {c.a, c.b} == {"ours", "static"})
    own = table[
        (table["kind"] != "practice")
        & (table["question"] == one.question)
        & table["left"].isin([one.a, one.b])
        & table["right"].isin([one.a, one.b])
    ]
    side = np.where(own["right"] == one.a, 1.0, -1.0)
    towards = side * (own["response"] - 3)
    share = clustered_mean(
        ((np.sign(towards) + 1) / 2).to_numpy(),
        own["participant"].to_numpy(str),
        own["segment"].to_numpy(str),
    )
    random = [
        RandomEffect(name=name, groups=own[name].to_numpy(str), multiplier=side)
        for name in ("participant", "segment")
    ]
    full = fit(own["response"].to_numpy(int), {"s": side}, random)
    reduced = fit(own["response"].to_numpy(int), {}, random)

    assert one.n == len(own) == sum(one.counts.values())
    assert one.counts["a_strong"] == (towards == 2).sum()
    assert one.counts["b_weak"] == (towards == -1).sum()
    assert sum(one.share.values()) == pytest.approx(100)
    assert (one.win_share.estimate, one.win_share.low, one.win_share.high) == pytest.approx(
        (share.estimate, share.low, share.high)
    )
    assert one.clmm.estimate == pytest.approx(full.estimates["s"], abs=1e-4)
    assert one.clmm.se == pytest.approx(full.standard_errors["s"], rel=1e-3)
    assert one.clmm.loglik == pytest.approx(full.log_likelihood, abs=1e-4)
    assert one.clmm.p == pytest.approx(likelihood_ratio(full, reduced)[2], rel=1e-3)
    assert one.as_published.binomial_p < one.clmm.p
    assert [c.p_holm for c in found.comparisons] == pytest.approx(
        holm([c.clmm.p for c in found.comparisons])
    )


def test_the_condition_that_appears_first_is_a(tmp_path: Path) -> None:
    table = pairwise_table(("x", "y"), effects=(0.8, 0.0), participants=8, segments=6)
    mirrored = table.assign(
        left=table["right"], right=table["left"], response=6 - table["response"]
    )
    [one], [other] = (results(tmp_path, of).comparisons for of in (table, mirrored))
    assert (one.a, one.b) == (other.b, other.a)
    assert one.a == table["left"].iloc[0]
    assert one.win_share.estimate == pytest.approx(1 - other.win_share.estimate)
    assert one.clmm.estimate == pytest.approx(-other.clmm.estimate, abs=1e-4)
    assert one.counts["a_strong"] == other.counts["b_strong"]


def test_practice_is_dropped_and_its_repetition_analysed(tmp_path: Path) -> None:
    table = pairwise_table(("x", "y"), effects=(0.5, 0.0), participants=4, segments=5)
    found = results(tmp_path, table)
    assert found.comparisons[0].n == 4 * 5
    contrary = table["response"].where(table["kind"] != "practice", 6 - table["response"])
    assert results(tmp_path, table.assign(response=contrary)).comparisons == found.comparisons
    assert found.test_retest["emotion"].n == 4 * 2  # type: ignore[union-attr]


def test_who_is_left_out_is_counted_and_not_analysed(tmp_path: Path) -> None:
    table = pairwise_table(("ours", "other"), effects=(0.5, 0.0), participants=4, segments=3)
    found = analyse(tmp_path, pd.concat([table, catch_rows("p01", "lr", (3, 3))]))
    [one] = found.results.comparisons  # type: ignore[union-attr]
    assert (one.recruited, one.attentive) == (4, 3)
    assert one.n == 3 * 3
    assert one.without_exclusions.n == 4 * 3
    assert "broken" not in found.conditions_shown


def test_sets_are_kept_apart_and_corrected_together(tmp_path: Path) -> None:
    table = pairwise_table(("x", "y"), effects=(0.8, 0.0), participants=6, segments=6)
    apart = table.assign(set=np.where(table["segment"] < "s3", "one", "two"))
    found = results(tmp_path, apart)
    alone = results(tmp_path, table[table["segment"] < "s3"])
    first, second = found.comparisons
    assert (first.set, second.set) == ("one", "two")
    assert first.clmm == alone.comparisons[0].clmm
    assert found.bradley_terry["one"]["emotion"] == alone.bradley_terry["emotion"]  # type: ignore[index]
    assert (first.p_holm, second.p_holm) == pytest.approx(holm([first.clmm.p, second.clmm.p]))


def test_equivalence_is_told_where_a_margin_was_stated(found: PairwiseResults) -> None:
    assert len(found.equivalence) == len(found.comparisons)
    for one, comparison in zip(found.equivalence, found.comparisons, strict=True):
        assert one.estimate == pytest.approx(comparison.win_share.estimate - 0.5)
        inside = one.low > -0.45 and one.high < 0.45
        assert one.verdict.startswith("equivalent") == inside


def test_strengths_add_up_to_zero_and_follow_the_truth(found: PairwiseResults) -> None:
    fitted = found.bradley_terry["rhythm"]
    strengths = fitted.strengths  # type: ignore[union-attr]
    assert sum(strengths.values()) == pytest.approx(0, abs=1e-9)
    assert strengths["ours"] > strengths["other"] > strengths["static"]
    assert set(fitted.ranks) == set(strengths)  # type: ignore[union-attr]


def test_with_few_segments_the_win_share_decides_and_the_model_says_why(tmp_path: Path) -> None:
    few = results(tmp_path, pairwise_table(("x", "y"), effects=(0.6, 0.0), segments=6))
    [one] = few.comparisons
    assert one.decided_by == "win_share"
    assert one.deciding_p == one.win_share.p
    assert one.deciding_p_holm == one.win_share_p_holm
    assert "12 participants and 6 segments" in one.clmm.remark

    many = pairwise_table(("x", "y"), effects=(0.6, 0.0), participants=20, segments=20)
    [other] = results(tmp_path, many).comparisons
    assert other.decided_by == "clmm"
    assert other.deciding_p_holm == other.p_holm == other.clmm.p
    assert "too often" not in other.clmm.remark
