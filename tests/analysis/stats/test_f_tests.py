import numpy as np
import pandas as pd
import pytest
from scipy import stats
from statsmodels.formula.api import ols
from statsmodels.stats.anova import AnovaRM, anova_lm

from analysis.stats.f_tests import between_groups, between_segments, min_f
from tests.analysis.stats.tables import cells


def test_min_f_combines_the_two_t_tests() -> None:
    generator = np.random.default_rng(7)
    table = 0.4 + generator.normal(0, 0.5, (20, 1)) + generator.normal(0, 1, (20, 12))
    result = min_f(*cells(table))
    f1 = stats.ttest_1samp(table.mean(axis=1), 0).statistic ** 2
    f2 = stats.ttest_1samp(table.mean(axis=0), 0).statistic ** 2
    assert result.statistic == pytest.approx(f1 * f2 / (f1 + f2))
    assert result.df_rest == pytest.approx((f1 + f2) ** 2 / (f1**2 / 11 + f2**2 / 19))
    assert result.p_value == pytest.approx(stats.f.sf(result.statistic, 1, result.df_rest))
    assert result.statistic < min(f1, f2)


def test_an_unbalanced_sample_counts_every_participant_and_item_once() -> None:
    values = np.array([1.0, 1, 1, 0, 2, 1])
    people, items = np.array([0, 0, 0, 0, 1, 1]), np.array([0, 0, 0, 1, 0, 1])
    of_participants = stats.ttest_1samp([0.75, 1.5], 0).statistic ** 2
    of_items = stats.ttest_1samp([1.25, 0.5], 0).statistic ** 2
    assert min_f(values, people, items).statistic == pytest.approx(
        1 / (1 / of_participants + 1 / of_items)
    )


def test_identical_participants_leave_the_test_to_the_items() -> None:
    table = [[1, 2, 0], [1, 2, 0], [0, 2, 1]]
    result = min_f(*cells(table))
    of_items = stats.ttest_1samp(np.mean(table, axis=0), 0).statistic ** 2
    assert result.statistic == pytest.approx(of_items)
    assert result.df_rest == pytest.approx(2)
    nothing = min_f(*cells([[1, -1, 0], [0, 1, -1]]))
    assert (nothing.statistic, nothing.p_value, nothing.reason) == (0.0, 1.0, "")


def made() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return answers of 14 participants about 12 segments in 4 groups."""
    chance = np.random.default_rng(1)
    people, what = np.repeat(np.arange(14), 12), np.tile(np.arange(12), 14)
    group = what % 4
    values = chance.normal(size=4)[group] + 0.5 * chance.normal(size=12)[what]
    values += 0.5 * chance.normal(size=(14, 4))[people, group] + chance.normal(size=14)[people]
    return values + chance.normal(size=len(people)), group, people, what


def test_group_comparison_combines_the_two_analyses_of_variance() -> None:
    values, group, people, items = made()
    frame = pd.DataFrame({"y": values, "group": group, "who": people, "what": items})
    within = AnovaRM(frame, "y", "who", within=["group"], aggregate_func="mean").fit()
    f_people = within.anova_table["F Value"].iloc[0]
    means = frame.groupby(["what", "group"], as_index=False)["y"].mean()
    f_items = anova_lm(ols("y ~ C(group)", means).fit())["F"].iloc[0]

    result = between_groups(values, group, people, items)

    assert result.statistic == pytest.approx(f_people * f_items / (f_people + f_items))
    assert result.df == 3
    assert result.df_rest == pytest.approx(
        (f_people + f_items) ** 2 / (f_people**2 / 8 + f_items**2 / 39)
    )


def test_segments_are_compared_within_participants() -> None:
    values, _, people, items = made()
    some = np.random.default_rng(3).random(len(values)) < 0.7
    frame = pd.DataFrame({"y": values, "who": people, "what": items})[some]
    table = anova_lm(ols("y ~ C(who) + C(what)", frame).fit())

    result = between_segments(values[some], people[some], items[some])

    assert result.statistic == pytest.approx(table["F"].loc["C(what)"])
    assert result.p_value == pytest.approx(table["PR(>F)"].loc["C(what)"])
    assert (result.df, result.df_rest) == (11, table["df"].loc["Residual"])
