from __future__ import annotations

from datetime import UTC, timedelta

import pytest

from studyapp.clock import Clock


def test_the_clock_tells_utc() -> None:
    assert Clock().now().tzinfo is UTC


def test_only_what_counts_as_passed_is_sped_up() -> None:
    slow, fast = Clock(), Clock(speed=100.0)
    moment = slow.now() - timedelta(seconds=10)

    assert slow.seconds_since(moment) == pytest.approx(10, abs=1)
    assert fast.seconds_since(moment) == pytest.approx(1000, abs=100)
    assert abs(fast.now() - slow.now()) < timedelta(seconds=1)


def test_a_moment_to_come_is_no_time_ago() -> None:
    assert Clock().seconds_since(Clock().now() + timedelta(hours=1)) == 0
