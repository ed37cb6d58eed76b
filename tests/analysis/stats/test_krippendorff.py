from __future__ import annotations

import math

import krippendorff
import numpy as np
import pandas as pd
import pytest

from analysis.stats.krippendorff import krippendorff_alpha
from motion.errors import InputError
from tests.analysis.reference import REFERENCE, with_reference

PUBLISHED = {"nominal": 0.743, "ordinal": 0.815, "interval": 0.849, "ratio": 0.797}


def answers(table):
    """Return values, raters and items of a table of raters (rows) by items; NaN is missing."""
    table = np.asarray(table, float)
    raters, items = np.indices(table.shape)
    there = ~np.isnan(table)
    return table[there], raters[there], items[there]


def drawn(seed=1, raters=8, items=15, missing=0.3):
    generator = np.random.default_rng(seed)
    table = np.rint(
        np.clip(generator.normal(3, 1, items) + generator.normal(0, 1, (raters, items)), 1, 5)
    )
    return np.where(generator.random(table.shape) < missing, np.nan, table)


@with_reference
@pytest.mark.parametrize("level", PUBLISHED)
def test_it_is_what_krippendorff_published(level):
    table = pd.read_csv(REFERENCE / "krippendorff2011.csv").melt("observer").dropna()
    found = krippendorff_alpha(
        table["value"].to_numpy(),
        table["observer"].to_numpy(str),
        table["variable"].to_numpy(str),
        level=level,
    )
    assert round(found.estimate, 3) == PUBLISHED[level]
    assert (found.n, found.items, found.participants) == (40, 11, 4)
    assert found.low < found.estimate < found.high


@pytest.mark.parametrize("level", PUBLISHED)
@pytest.mark.parametrize("seed", [1, 2])
def test_it_agrees_with_another_implementation(level, seed):
    table = drawn(seed)
    expected = krippendorff.alpha(table, level_of_measurement=level)
    found = krippendorff_alpha(*answers(table), level=level, resamples=50)
    assert found.estimate == pytest.approx(expected)


def test_a_resample_is_alpha_of_the_items_drawn():
    table = drawn(items=2, missing=0)
    both = krippendorff_alpha(*answers(table), resamples=400)
    alone = [
        krippendorff.alpha(np.repeat(table[:, [item]], 2, axis=1), level_of_measurement="ordinal")
        for item in (0, 1)
    ]
    assert both.low == pytest.approx(min(*alone, both.estimate))
    assert both.high == pytest.approx(max(*alone, both.estimate))


def test_agreement_about_every_item_is_one():
    found = krippendorff_alpha(*answers([[1, 2, 3], [1, 2, 3], [1, 2, 3]]))
    assert found.estimate == 1
    assert found.high == 1


def test_a_common_preference_without_agreement_about_items_is_near_zero():
    generator = np.random.default_rng(5)
    table = np.clip(np.rint(4 + generator.normal(0, 1, (30, 40))), 1, 5)
    assert abs(krippendorff_alpha(*answers(table), resamples=50).estimate) < 0.02


def test_the_same_seed_gives_the_same_interval():
    data = answers(drawn())
    assert krippendorff_alpha(*data, seed=3) == krippendorff_alpha(*data, seed=3)
    assert krippendorff_alpha(*data, seed=3) != krippendorff_alpha(*data, seed=4)


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        (np.zeros((2, 0)), "no item was answered about by two participants"),
        ([[1, np.nan], [np.nan, 2]], "no item was answered about by two participants"),
        ([[3, 3], [3, 3]], "all answers alike"),
    ],
)
def test_no_alpha_comes_with_its_reason(table, reason):
    found = krippendorff_alpha(*answers(table))
    assert found.reason == reason
    assert math.isnan(found.estimate)


def test_one_item_has_an_alpha_but_no_interval():
    found = krippendorff_alpha(*answers([[1], [2], [1]]))
    assert found.estimate == pytest.approx(0)
    assert math.isnan(found.low)
    assert found.reason == "one item gives no interval"


def test_two_answers_of_one_participant_about_an_item_are_refused():
    with pytest.raises(InputError, match="answered twice"):
        krippendorff_alpha(np.array([1, 2]), np.array(["a", "a"]), np.array(["x", "x"]))
