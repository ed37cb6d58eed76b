import pytest

from analysis.results.against_people.over_conditions import compatible, sampling_range


def test_ten_conditions_show_a_true_half_as_anything_from_nearly_none_to_nearly_all():
    found = sampling_range(10)
    assert (round(found.low, 2), round(found.high, 2)) == (0.07, 0.82)


def test_more_conditions_show_more():
    widths = [sampling_range(k).high - sampling_range(k).low for k in (5, 10, 20)]
    assert widths == sorted(widths, reverse=True)


def test_four_conditions_in_perfect_order_do_not_rule_out_that_there_is_no_relation():
    low, high = compatible(1.0, 4, "kendall")
    assert low < 0
    assert high == 1


def test_ten_conditions_in_perfect_order_do():
    assert compatible(1.0, 10, "kendall")[0] > 0.7


@pytest.mark.parametrize("kind", ["kendall", "spearman"])
def test_what_fits_lies_around_the_estimate_and_is_mirrored_with_it(kind):
    low, high = compatible(0.4, 6, kind)
    assert low < 0.4 < high
    assert compatible(-0.4, 6, kind) == (-high, -low)
