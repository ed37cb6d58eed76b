from datetime import timedelta

import pytest

from studyapp.clock import Clock, has_passed


def test_only_study_time_is_sped_up() -> None:
    slow, fast = Clock(), Clock(speed=100.0)
    moment = slow.now() - timedelta(seconds=10)

    assert slow.seconds_since(moment) == pytest.approx(10, abs=1)
    assert fast.seconds_since(moment) == pytest.approx(1000, abs=100)
    assert abs(fast.now() - slow.now()) < timedelta(seconds=1)
    # The time since a future moment is unknown.
    assert slow.seconds_since(slow.now() + timedelta(hours=1)) is None


@pytest.mark.parametrize(
    ("ago", "passed"),
    [
        (timedelta(minutes=9), False),
        (timedelta(minutes=10), True),
        (-timedelta(seconds=20), False),
        (-timedelta(hours=1), True),
    ],
)
def test_a_clock_set_back_makes_nobody_wait(ago: timedelta, *, passed: bool) -> None:
    now = Clock().now()

    assert has_passed(timedelta(minutes=10), now - ago, now) is passed
