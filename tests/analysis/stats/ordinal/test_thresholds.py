from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.stats.ordinal.thresholds import Structure, Thresholds

STRUCTURES: tuple[Structure, ...] = ("flexible", "symmetric", "symmetric around zero")


@given(st.data(), st.integers(2, 8), st.sampled_from(STRUCTURES))
def test_thresholds_are_always_in_order(
    data: st.DataObject, categories: int, structure: Structure
) -> None:
    thresholds = Thresholds(categories, structure)
    numbers = st.floats(-3, 3)
    free = data.draw(st.lists(numbers, min_size=thresholds.count, max_size=thresholds.count))

    values = thresholds.values(np.array(free))

    assert values.shape == (categories - 1,)
    assert (np.diff(values) > 0).all()
    if structure != "flexible":
        middle = (values + values[::-1]) / 2
        np.testing.assert_allclose(middle, middle[0], atol=1e-9)
    if structure == "symmetric around zero":
        np.testing.assert_allclose(values, -values[::-1], atol=1e-9)


@pytest.mark.parametrize("structure", STRUCTURES)
def test_the_jacobian_is_the_derivative(structure: Structure) -> None:
    thresholds = Thresholds(5, structure)
    free = np.linspace(-0.4, 0.3, thresholds.count)
    steps = 1e-6 * np.eye(thresholds.count)

    numeric = [(thresholds.values(free + e) - thresholds.values(free - e)) / 2e-6 for e in steps]

    np.testing.assert_allclose(thresholds.jacobian(free), np.transpose(numeric), atol=1e-8)


def test_it_starts_where_the_counts_are_met() -> None:
    thresholds = Thresholds(3)

    values = thresholds.values(thresholds.start(np.array([25, 50, 25])))

    np.testing.assert_allclose(values, [-np.log(3), np.log(3)], atol=0.05)
