import math

import numpy as np
import pandas as pd
import pytest

from analysis.planning.deciding_tests import (
    block_tests,
    clustered_tests,
    decided_by_holm,
    detection_shares,
    worth_tests,
)
from analysis.planning.part import Kind, Opinions, Part, simulate_answers
from analysis.planning.power import Power, simulate_power
from analysis.results.mixed_models import SidedAnswers, net_preference
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm
from analysis.stats.strength_differences import difference_tests
from analysis.stats.strength_models import plackett_luce
from tests.analysis.planning.sketch import sketched

ALIKE = Opinions(participant_sd=0.3, item_sd=0.3)


def power(part: Part, effect: float) -> Power:
    return simulate_power((part,), ALIKE, effect, (1, 2), studies=400)[0]


@pytest.mark.parametrize(("kind", "conditions"), [("pairs", 2), ("ratings", 3), ("rankings", 3)])
def test_power_grows_with_the_effect_and_false_positives_stay_at_the_level(
    kind: Kind, conditions: int
) -> None:
    part = sketched(kind, 12, 8, conditions=conditions)
    nothing, some, much = (power(part, effect).power for effect in (0.0, 0.5, 1.2))

    assert nothing <= 0.06
    assert nothing < some < much
    assert much > 0.6


def test_more_tests_are_corrected_more() -> None:
    one, six = (power(sketched("pairs", 12, 10, blocks=blocks), 0.6) for blocks in (1, 6))

    assert six.power < six.uncorrected
    assert six.uncorrected == pytest.approx(one.power)


def test_the_win_share_decides_for_few_participants() -> None:
    pairs = sketched("pairs", 10, 30)
    people, segments = pairs.trials.participants, pairs.trials.items
    answers = simulate_answers(pairs, ALIKE, 0.4, 4, np.random.default_rng(1))

    tested = block_tests(pairs, answers)

    for study, given in enumerate(answers):
        alone = clustered_mean((np.sign(given) + 1) / 2, people, segments)
        assert tested.p_values[study, 0] == pytest.approx(alone.p_value)
        assert tested.signs[study, 0] == np.sign(alone.estimate - 0.5)


@pytest.mark.slow
def test_the_mean_preference_finds_about_as_much_as_the_mixed_model() -> None:
    pairs = sketched("pairs", 25, 24)
    left, right = pairs.trials.sides
    answers = simulate_answers(pairs, Opinions(), 0.4, 200, np.random.default_rng(1))
    tested = block_tests(pairs, answers)
    fits = [
        net_preference(
            SidedAnswers(
                responses=3 + np.where(left > right, given, -given).astype(np.int64),
                on_right=left > right,
                participants=pairs.trials.participants,
                segments=pairs.trials.items,
            )
        )
        for given in answers
    ]

    found = (np.array([fit.p_value for fit in fits]) < 0.05) & ([fit.estimate > 0 for fit in fits])
    quick = (tested.p_values[:, 0] < 0.05) & (tested.signs[:, 0] > 0)
    assert np.mean(quick == found) > 0.9
    assert quick.mean() == pytest.approx(found.mean(), abs=0.05)


def test_rankings_are_decided_by_the_worths_of_each_study() -> None:
    rankings = sketched("rankings", 22, 8, conditions=3)
    names = ("0", "1", "2")
    answers = simulate_answers(rankings, Opinions(), 0.8, 20, np.random.default_rng(1))
    tested = worth_tests(answers, rankings.trials)
    shown = pd.DataFrame(
        {
            "ranking": np.repeat(np.arange(22 * 8), 3),
            "participant": np.repeat(rankings.trials.participants, 3),
            "segment": np.repeat(rankings.trials.items, 3),
            "condition": np.tile(names, 22 * 8),
        }
    )

    for study, ranks in enumerate(answers):
        fit = plackett_luce(shown.assign(rank=ranks.ravel()), names)
        assert fit.two_way is not None
        p_values = difference_tests(fit.strengths, fit.two_way)[[0, 0, 1], [1, 2, 2]]
        assert tested.p_values[study] == pytest.approx(p_values, abs=0.02, rel=0.1)
        assert tested.signs[study, 0] == np.sign(fit.strengths[0] - fit.strengths[1])


def test_a_condition_that_wins_every_ranking_is_found() -> None:
    rankings = sketched("rankings", 10, 8, conditions=3)
    ranks = np.tile([[1.0, 2, 3], [1, 3, 2]], (40, 1))[None]

    tested = worth_tests(ranks, rankings.trials)

    assert tested.p_values[0, 0] < 0.001
    assert tested.signs[0, :2].tolist() == [1, 1]


POWERS = {
    0.2: ((25, 24, 0.20), (50, 24, 0.31), (100, 24, 0.41), (25, 48, 0.25)),
    0.4: ((25, 24, 0.64), (50, 24, 0.82), (25, 48, 0.76)),
    0.6: ((25, 24, 0.93), (50, 24, 0.99), (25, 48, 0.99)),
}
"""By effect: participants, items and the power of a crossed linear mixed model of scores."""


@pytest.mark.slow
@pytest.mark.parametrize("effect", POWERS)
def test_the_power_of_scores_is_near_that_of_a_crossed_mixed_model(effect: float) -> None:
    for participants, items, known in POWERS[effect]:
        part = sketched("pairs", participants, items)
        (result,) = simulate_power((part,), Opinions(), effect, (1,), studies=2000)

        assert result.power == pytest.approx(known, abs=0.05)


def test_many_studies_are_tested_as_each_of_them_would_be() -> None:
    chance = np.random.default_rng(5)
    shown = np.flatnonzero(chance.random(12 * 9) < 0.4)
    people, items = shown // 9, shown % 9
    values = chance.integers(-2, 3, (40, len(shown))).astype(float)
    values[3] = 1.0
    values[4] = 0.0

    means, p_values = clustered_tests(values, people, items)

    for row, mean, p in zip(values, means, p_values, strict=True):
        alone = clustered_mean(row, people, items, null=0.0, limits=(-2.0, 2.0))
        assert mean == pytest.approx(alone.estimate)
        assert p == pytest.approx(alone.p_value, nan_ok=True)
    assert np.isnan(p_values[3:5]).all()
    assert not np.isnan(np.delete(p_values, [3, 4])).any()
    _, of_one_participant = clustered_tests(values, np.zeros_like(people), items)
    assert np.isnan(of_one_participant).all()


@pytest.mark.parametrize(
    ("block", "company", "decided"),
    [
        ([0.01, 0.04, 0.2], None, [1, 0, 0]),
        ([0.03, 0.02, 0.04], None, [0, 0, 0]),
        ([math.nan, 0.001], None, [0, 1]),
        # Among four blocks without an effect a test needs five times the evidence, among certain
        # ones hardly more.
        ([0.02], 0.9, [0]),
        ([0.009], 0.9, [1]),
        ([0.04], 1e-6, [1]),
    ],
)
def test_a_block_is_corrected_with_the_rest_of_its_family(
    block: list[float], company: float | None, decided: list[float]
) -> None:
    p_values = np.array([block])
    rest = [(np.full((10, 1), company or 0.0), 4 if company else 0)]

    if len(block) == 3:
        assert [p < 0.05 for p in holm(block)] == [bool(share) for share in decided]
    assert decided_by_holm(p_values, rest, 1).tolist() == [decided]


def test_a_difference_counts_as_found_only_in_the_right_direction() -> None:
    signs, decided = np.array([[1.0, 1.0], [-1.0, 1.0]]), np.ones((2, 2))

    assert detection_shares(signs, decided, (True, False), effect=0.4).tolist() == [1.0, 0.0]
    assert detection_shares(signs, decided, (True, False), effect=0.0).tolist() == [1.0, 1.0]
