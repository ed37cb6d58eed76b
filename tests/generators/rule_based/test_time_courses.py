"""Minimum-jerk movements and their superposition."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from generators.rule_based.time_courses import Movement, follow, minimum_jerk, pulse, swell


@given(st.floats(-2, 3), st.floats(-2, 3))
def test_it_rises_from_nothing_to_all(one: float, other: float) -> None:
    low, high = minimum_jerk(np.array(sorted((one, other))))
    assert 0 <= low <= high <= 1 + 1e-12


def test_it_starts_and_ends_without_speed_or_acceleration() -> None:
    step = 1e-3
    share = minimum_jerk(np.arange(-2.0, 3.0) * step)
    assert np.abs(np.diff(share) / step).max() < 1e-4
    assert np.abs(np.diff(share, 2) / step**2).max() < 0.2
    np.testing.assert_allclose(minimum_jerk(np.array([0.0, 0.5, 1.0])), [0, 0.5, 1])


def test_its_peak_speed_is_fifteen_eighths_of_the_mean() -> None:
    share = minimum_jerk(np.linspace(0, 1, 2001))
    assert np.diff(share).max() * 2000 == pytest.approx(15 / 8, rel=1e-4)


def test_a_swell_leaves_both_ends_alone() -> None:
    np.testing.assert_allclose(swell(np.array([-1, 0, 0.5, 1, 2])), [0, 0, 1, 0, 0])


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=5), st.floats(0.1, 0.9))
def test_movements_arrive_at_their_targets_even_where_they_overlap(
    targets: list[float], overlap: float
) -> None:
    movements = [
        Movement(start=k * overlap, end=k * overlap + 1, target=np.array([target]))
        for k, target in enumerate(targets)
    ]
    course = follow(np.array([0.3]), movements, np.array([-1.0, 50.0]))
    np.testing.assert_allclose(course[:, 0], [0.3, targets[-1]], atol=1e-9)


def test_a_bow_bends_the_way_and_not_the_ends() -> None:
    movement = Movement(start=0, end=1, target=np.array([1.0, 0.0]), bow=np.array([0.0, 0.2]))
    course = follow(np.zeros(2), [movement], np.array([0.0, 0.5, 1.0]))
    np.testing.assert_allclose(course, np.array([[0, 0], [0.5, 0.2], [1, 0]]), atol=1e-12)


def test_a_pulse_peaks_where_it_should() -> None:
    times = np.linspace(0, 2, 401)
    course = pulse(times, 1.0, 0.2, 0.5)
    assert times[np.argmax(course)] == pytest.approx(1.0)
    assert not course[(times < 0.8) | (times > 1.5)].any()
