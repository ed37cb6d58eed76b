from itertools import pairwise

import numpy as np
import pytest
from scipy import stats

from benchmarks.validity.studies import Design, preferences, true_outcomes
from tools.worked_examples.spread import Spread, with_spread

STUDIES = 600


def test_without_spread_answers_are_independent() -> None:
    found = with_spread(
        0.46, 0.39, participants=22, items=24, spread=Spread(participants=0, items=0)
    )

    share = 0.535
    error = np.sqrt((0.46 + 0.15 / 4 - share**2) / (22 * 24))
    reach = stats.t.ppf(0.975, 21) * error
    assert found.design_effect == pytest.approx(1)
    assert (found.low, found.high) == pytest.approx((share - reach, share + reach))
    assert found.p_value == pytest.approx(2 * stats.t.sf((share - 0.5) / error, 21))


@pytest.mark.parametrize(("participant_sd", "item_sd"), [(0.6, 0.0), (0.6, 0.45), (1.0, 0.8)])
def test_win_shares_of_simulated_studies_vary_as_much_as_is_said(
    participant_sd: float, item_sd: float
) -> None:
    design = Design(
        participants=22, items=24, effect=0.4, participant_sd=participant_sd, item_sd=item_sd
    )
    chance = np.random.default_rng(5)
    shares = [preferences(design, chance).wins.mean() for _ in range(STUDIES)]
    wins, _, losses = true_outcomes(design)

    found = with_spread(
        wins,
        losses,
        participants=22,
        items=24,
        spread=Spread(participants=participant_sd, items=item_sd),
    )

    reach = stats.t.ppf(0.975, 21)
    # The standard deviation of 600 shares is known within 6 % (two standard errors).
    assert np.std(shares) == pytest.approx((found.high - found.low) / (2 * reach), rel=0.09)
    assert np.mean(shares) == pytest.approx(found.win_share, abs=0.01)


def test_more_spread_makes_the_interval_wider_and_changing_sides_mirrors_it() -> None:
    widths = [
        with_spread(0.5, 0.3, participants=20, items=24, spread=Spread(participants=sd, items=sd))
        for sd in (0.0, 0.5, 1.0, 1.5)
    ]
    assert all(a.high - a.low < b.high - b.low for a, b in pairwise(widths))

    mirrored = with_spread(
        0.3, 0.5, participants=20, items=24, spread=Spread(participants=1.0, items=1.0)
    )
    assert mirrored.low == pytest.approx(1 - widths[2].high)
    assert mirrored.p_value == pytest.approx(widths[2].p_value)
