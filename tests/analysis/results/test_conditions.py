import math
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.stats.multiple_testing import holm
from tests.analysis.reference import reference_ratings, with_reference
from tests.analysis.results.made_tables import ranking_table, rating_table, report_of


def results(folder: Path, table: pd.DataFrame, protocol: str = "rating", **options: Any) -> Any:
    return report_of(table, protocol, folder, **options).results


@with_reference
def test_results_agree_with_r(tmp_path: Path) -> None:
    ratings, expected = reference_ratings()
    table = ratings.rename(columns={"item": "segment", "method": "condition", "rating": "response"})
    result = results(tmp_path, table.assign(question="match"), margin=0.3)

    for one in result.conditions:
        row = expected["table2"][one.condition]
        assert (one.n, one.estimate, one.sd) == pytest.approx((row["n"], row["mean"], row["sd"]))
        assert {str(score): n for score, n in one.counts.items()} == row["counts"]
        at_least = {str(score): percent for score, percent in one.at_least.items()}
        assert at_least == pytest.approx(row["cumulative_lower_bound_pct"], abs=1e-9)
    model, fitted = result.clmm.of_set(None)["match"], expected["clmm"]
    assert model.log_likelihood == pytest.approx(fitted["loglik"], abs=1e-3)
    estimates = model.estimates
    for name, effect in fitted["beta"].items():
        condition = name.removeprefix("method")
        assert estimates[condition] - estimates["Ours"] == pytest.approx(effect, abs=1e-3)
    for row in expected["emmeans_pairs_unadjusted"]:
        pair = row["contrast"].split(" - ")
        contrast = next(c for c in result.contrasts if {c.a, c.b} == set(pair))
        sign = 1 if contrast.a == pair[0] else -1
        assert contrast.log_odds == pytest.approx(sign * row["estimate"], abs=1e-3)
        assert contrast.odds_ratio == pytest.approx(math.exp(contrast.log_odds))


def test_a_slider_of_many_steps_has_means_but_no_ordinal_model(tmp_path: Path) -> None:
    table = rating_table(("x", "y"), participants=8, segments=4)
    steps = np.random.default_rng(1).integers(0, 20, len(table))
    result = results(tmp_path, table.assign(response=20 * (table["response"] - 1) + steps))
    assert result.conditions[0].estimate > 20
    assert not result.conditions[0].reason
    assert "too many for ordered categories" in result.clmm.of_set(None)["match"].reason
    assert result.contrasts[0].cliffs_delta.estimate > 0
    assert result.contrasts[0].remark


def test_paired_differences_of_all_questions_are_one_family_unless_it_is_declared_by_question(
    tmp_path: Path,
) -> None:
    table = rating_table(("x", "y", "z"), ("match", "style"), participants=8, segments=5)
    result = results(tmp_path, table).contrasts

    by_question = results(tmp_path, table, family="by question").contrasts
    for contrasts, size in ((result, 6), (by_question, 3)):
        p_values = [one.difference.p_value for one in contrasts]
        corrected = [*holm(p_values[:size]), *holm(p_values[size:])]
        assert [one.difference.p_holm for one in contrasts] == pytest.approx(corrected)
    for one in result:
        own = table[table["question"] == one.question].pivot(
            index=["participant", "segment"], columns="condition", values="response"
        )
        assert one.difference.estimate == pytest.approx((own[one.a] - own[one.b]).mean())
        assert one.difference.n == 40
        assert one.difference.low < one.difference.estimate < one.difference.high


def test_equivalence_is_tested_by_the_difference_of_paired_ratings(tmp_path: Path) -> None:
    table = rating_table(("x", "y"), participants=10, segments=6)
    result = results(tmp_path, table, margin=0.4)

    [one], [contrast] = result.equivalence, result.contrasts
    assert one.estimate == pytest.approx(contrast.difference.estimate)
    assert one.high - one.low < contrast.difference.high - contrast.difference.low
    inside = one.low > -0.4 and one.high < 0.4
    assert one.verdict.startswith("equivalent") == inside


def test_intervals_are_clipped_only_at_a_stated_scales_ends(tmp_path: Path) -> None:
    table = rating_table(("x", "y"), participants=3, segments=3)
    table["response"] = [5, 5, 4] * 6

    def highest(scale: tuple[int, int] | None) -> float:
        conditions = results(tmp_path, table, scale=scale).conditions
        return float(max(condition.high for condition in conditions))

    assert highest((1, 5)) == 5
    assert 5 < highest((1, 7)) == highest(None) < 7


def test_worths_and_ranks_follow_the_truth_with_segments_as_a_sample(tmp_path: Path) -> None:
    result = results(tmp_path, ranking_table(participants=15), "ranking")
    fitted = result.plackett_luce.of_set(None)["realism"]
    worths = {condition.condition: condition.estimate for condition in fitted.conditions}
    assert sum(worths.values()) == pytest.approx(0, abs=1e-9)
    assert worths["truth"] > worths["ours"] > worths["static"]
    for condition in fitted.conditions:
        assert condition.low < condition.estimate < condition.high
    assert "4.96 degrees of freedom" in fitted.method
    agreed = result.kendall_w.of_set(None)["realism"]
    assert 0 < agreed.low < agreed.estimate < agreed.high <= 1
    assert len(agreed.segments) == 6
    pairs = [*combinations(("truth", "ours", "static"), 2)]
    assert [(pair.a, pair.b) for pair in result.posthoc] == pairs
    assert all(pair.difference < 0 for pair in result.posthoc)


def test_an_empty_rank_leaves_a_condition_out_of_its_ranking(tmp_path: Path) -> None:
    table = ranking_table()
    empty = (table["condition"] == "static") & (table["segment"] == "s1")
    some = table["rank"].astype("Float64").mask(empty)
    result = results(tmp_path, table.assign(rank=some), "ranking")
    by_name = {condition.condition: condition for condition in result.conditions}
    assert by_name["truth"].n == 12 * 6
    assert by_name["static"].n == 12 * 5
    assert by_name["truth"].remark == "12 of 72 rankings leave conditions out"
