from __future__ import annotations

import math

import numpy as np
import pandas as pd
import pytest
from statsmodels.formula.api import ols
from statsmodels.stats.anova import AnovaRM, anova_lm

from analysis.stats.heterogeneity import between_groups, between_segments

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
