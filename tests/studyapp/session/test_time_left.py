from __future__ import annotations

from studyapp.session.time_left import expected_seconds, minutes_left


def test_all_players_of_a_page_count() -> None:
    assert expected_seconds([10.0, 10.0, 10.0], 1) - expected_seconds([10.0], 1) == 34.0


def test_many_answers_to_a_page_take_longer_than_its_videos() -> None:
    assert expected_seconds([10.0], 6) - expected_seconds([10.0], 2) == 16.0
    assert expected_seconds([10.0], 1) == expected_seconds([10.0], 0)


def test_before_the_first_answer_the_videos_tell() -> None:
    short, long = expected_seconds([10.0], 1), expected_seconds([60.0] * 5, 8)

    assert minutes_left([], [short]) == 1
    assert minutes_left([], [long] * 8 + [short] * 12) == 51


def test_the_participants_own_pace_is_carried_over_to_longer_trials() -> None:
    assert minutes_left([(50.0, 25.0)], [300.0] * 2) == 20


def test_one_long_interruption_changes_nothing() -> None:
    steady = [(30.0, 30.0), (30.0, 30.0)]

    assert minutes_left([*steady, (3600.0, 30.0)], [30.0] * 4) == minutes_left(steady, [30.0] * 4)


def test_something_is_always_left() -> None:
    assert minutes_left([(1.0, 60.0)], [10.0]) == 1
