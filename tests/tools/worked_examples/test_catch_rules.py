import pytest

from tools.worked_examples.catch_rules import excluded


def test_three_readings_of_a_rule_exclude_different_participants() -> None:
    found = excluded(0.1, 3)

    assert found.any_of_them == pytest.approx(1 - 0.9**3)
    assert found.more_than_one == pytest.approx(3 * 0.1**2 * 0.9 + 0.1**3)
    assert found.all_of_them == pytest.approx(0.1**3)
