import pytest

from tools.worked_examples.rounded import counts_behind, printable_neighbours


@pytest.mark.parametrize("total", [90, 528, 600])
@pytest.mark.parametrize("decimals", [0, 2])
def test_every_count_is_behind_the_percentage_it_is_printed_as(total: int, decimals: int) -> None:
    for count in range(total + 1):
        assert count in counts_behind(round(100 * count / total, decimals), total, decimals)


def test_whole_percent_of_many_answers_hide_several_counts() -> None:
    assert list(counts_behind(46, 528)) == [241, 242, 243, 244, 245]


def test_a_percentage_that_no_count_gives_has_none_behind_it_and_two_beside_it() -> None:
    assert not counts_behind(65.46, 90, 2)
    assert printable_neighbours(65.46, 90, 2) == (64.44, 65.56)


def test_counts_stay_between_none_and_all() -> None:
    assert counts_behind(0, 30) == range(1)
    assert counts_behind(100, 30) == range(30, 31)
