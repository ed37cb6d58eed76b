from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.formula.api import ols
from statsmodels.stats.anova import AnovaRM, anova_lm

from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.clustered_variance import ONE_SEGMENT
from analysis.stats.heterogeneity import between_groups, between_segments, cells

Study = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]


def made(groups: float = 0.0, items: float = 0.5, seed: int = 1) -> Study:
    """Return answers of 14 participants about 12 segments in 4 groups."""
    chance = np.random.default_rng(seed)
    who, what = np.repeat(np.arange(14), 12), np.tile(np.arange(12), 14)
    group = what % 4
    values = groups * chance.normal(size=4)[group] + items * chance.normal(size=12)[what]
    values = values + 0.5 * chance.normal(size=(14, 4))[who, group] + chance.normal(size=14)[who]
    return values + chance.normal(size=len(who)), group, who, what


def test_it_joins_the_two_analyses_of_variance() -> None:
    values, group, who, what = made(groups=1.0)
    frame = pd.DataFrame({"y": values, "group": group, "who": who, "what": what})
    within = AnovaRM(frame, "y", "who", within=["group"], aggregate_func="mean").fit()
    f_people = within.anova_table["F Value"].iloc[0]
    means = frame.groupby(["what", "group"], as_index=False)["y"].mean()
    f_items = anova_lm(ols("y ~ C(group)", means).fit())["F"].iloc[0]

    found = between_groups(values, group, who, what)

    assert found.statistic == pytest.approx(f_people * f_items / (f_people + f_items))
    assert found.df == 3
    assert found.df_rest == pytest.approx(
        (f_people + f_items) ** 2 / (f_people**2 / 8 + f_items**2 / 39)
    )


def test_segments_are_compared_within_participants() -> None:
    values, _, who, what = made()
    some = np.random.default_rng(3).random(len(values)) < 0.7
    frame = pd.DataFrame({"y": values, "who": who, "what": what})[some]
    table = anova_lm(ols("y ~ C(who) + C(what)", frame).fit())

    found = between_segments(values[some], who[some], what[some])

    assert found.statistic == pytest.approx(table["F"].loc["C(what)"])
    assert found.p_value == pytest.approx(table["PR(>F)"].loc["C(what)"])
    assert (found.df, found.df_rest) == (11, table["df"].loc["Residual"])


def test_segments_and_tastes_that_differ_are_no_difference_between_groups() -> None:
    found = [between_groups(*made(items=1.0, seed=seed)).p_value < 0.05 for seed in range(200)]

    assert np.mean(found) <= 0.08


def test_groups_that_differ_are_found() -> None:
    found = [between_groups(*made(groups=2.0, seed=seed)).p_value < 0.05 for seed in range(20)]

    assert np.mean(found) > 0.8


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda y, g, p, s: (y, 0 * g, p, s), "fewer than two groups"),
        (lambda y, g, p, s: (y, g, 0 * p, s), "fewer than two participants"),
        (lambda y, g, p, s: (y, g, p, g), "one segment in every group"),
        (lambda y, g, p, s: (0 * y, g, p, s), "all answers alike"),
        (lambda y, g, p, s: (y[:0], g[:0], p[:0], s[:0]), "fewer than two groups"),
    ],
)
def test_where_there_is_no_test_it_says_why(change, reason) -> None:  # type: ignore[no-untyped-def]
    found = between_groups(*change(*made()))

    assert reason in found.reason
    assert math.isnan(found.p_value)


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        (lambda y, p, s: (y, p, 0 * s), "one segment"),
        (lambda y, p, s: (y, np.arange(len(y)), s), "too few participants share segments"),
        (lambda y, p, s: (p + s.astype(float), p, s), "differ alike"),
        (lambda y, p, s: (0 * y, p, s), "differ alike"),
    ],
)
def test_segments_that_cannot_be_compared_are_not(change, reason) -> None:  # type: ignore[no-untyped-def]
    values, _, who, what = made()

    found = between_segments(*change(values, who, what))

    assert reason in found.reason
    assert math.isnan(found.p_value)


def made_wins() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    chance = np.random.default_rng(2)
    who, what = np.repeat(np.arange(9), 12), np.tile(np.arange(12), 9)
    return chance.integers(0, 3, len(who)) / 2, who, what


def test_a_level_of_many_segments_is_tested_as_a_whole_study_is() -> None:
    wins, who, what = made_wins()

    [first, second] = cells(wins, what // 6, ["anger", "joy"], who, what, null=0.5, limits=(0, 1))

    own = what < 6
    assert (first.level, second.level) == ("anger", "joy")
    whole = clustered_mean(wins[own], who[own], what[own])
    assert vars(whole).items() <= vars(first).items()
    assert not first.descriptive


def test_a_level_of_three_segments_is_described_and_not_tested() -> None:
    wins, who, what = made_wins()

    found = cells(wins, what // 3, list("abcd"), who, what, null=0.5, limits=(0, 1))

    for cell in found:
        assert cell.descriptive
        assert math.isnan(cell.p_value)
        assert cell.low < cell.estimate < cell.high
        assert cell.segments == 3


def test_a_single_segment_has_the_interval_of_its_participants() -> None:
    wins, who, what = made_wins()

    found = cells(wins, what, [f"s{n}" for n in range(12)], who, what, null=0.5)

    own = wins[what == 4]
    expected = stats.ttest_1samp(own, 0.5).confidence_interval()
    assert (found[4].low, found[4].high) == pytest.approx(tuple(expected))
    assert found[4].method == ONE_SEGMENT
    assert all(cell.descriptive for cell in found)


def test_levels_without_answers_are_left_out_and_others_say_why_they_have_no_interval() -> None:
    what = np.array([0, 0, 2])

    found = cells(
        np.array([1.0, 1.0, 0.0]), what, ["a", "b", "c"], np.array([0, 1, 0]), what, null=0.5
    )

    assert [cell.level for cell in found] == ["a", "c"]
    assert [cell.reason for cell in found] == ["all answers alike", "one participant"]
