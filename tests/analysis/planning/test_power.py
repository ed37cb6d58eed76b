from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from analysis.planning import grid
from analysis.planning.deciding_tests import (
    BlockTests,
    DecidingTests,
    clustered_tests,
    decided_by_holm,
    detection_shares,
)
from analysis.planning.grid import Task, simulate_cell
from analysis.planning.part import Opinions, Part, simulate_answers
from analysis.planning.power import Effort, Power, simulate_power
from analysis.results.mixed_models import SidedAnswers, net_preference
from analysis.stats.clustered_mean import clustered_mean
from analysis.stats.multiple_testing import holm, holm_rows
from tests.analysis.planning.sketch import Sketch

ALIKE = Opinions(participant_sd=0.3, item_sd=0.3)
QUICK = Effort(quick=400, exact=40)

PAIRS = Sketch(kind="pairs", own_participants=True)
RATINGS, RANKINGS = Sketch(kind="ratings", conditions=3), Sketch(kind="rankings", conditions=3)

# After an intended change, raise the version in the module and update the numbers here.
POWERS_OF_VERSION = {
    "3": {
        "pairs": [0.65625, 0.59, 0.71, 0.073482],
        "ratings": [0.51, 0.51, 0.65, 0.039911],
        "rankings": [0.43875, 0.385625, 0.7, 0.058083],
    }
}


def part(sketch: Sketch, participants: int, items: int) -> Part:
    (result,) = sketch.size(participants, items, excluded=0.0).parts
    return result


def power(sketch: Sketch, participants: int, items: int, effect: float) -> Power:
    parts = (part(sketch, participants, items),)
    return simulate_power(parts, ALIKE, effect, QUICK, (1, 2))[0]


@pytest.mark.parametrize("sketch", [PAIRS, RATINGS, RANKINGS], ids=lambda sketch: sketch.kind)
def test_power_grows_with_the_effect_and_false_positives_stay_at_the_level(
    sketch: Sketch,
) -> None:
    nothing, some, much = (power(sketch, 12, 8, effect).power for effect in (0.0, 0.5, 1.2))

    assert nothing <= 0.06
    assert nothing < some < much
    assert much > 0.6


def test_more_tests_are_corrected_more() -> None:
    six = power(replace(PAIRS, questions=6), 12, 10, 0.6)
    rankings = power(replace(RANKINGS, questions=3), 12, 10, 0.9)

    assert six.alone <= six.power < six.uncorrected
    assert six.uncorrected == pytest.approx(power(PAIRS, 12, 10, 0.6).power)
    assert rankings.alone < rankings.power < rankings.uncorrected


@pytest.mark.parametrize(("participants", "items", "by_model"), [(10, 30, False), (20, 20, True)])
def test_the_win_share_decides_for_few_participants_and_the_mixed_model_for_many(
    participants: int, items: int, by_model: bool
) -> None:
    pairs = part(PAIRS, participants, items)
    people, segments = pairs.trials.participants, pairs.trials.items
    tests = DecidingTests(pairs)
    answers = simulate_answers(pairs, ALIKE, 0.4, 4, np.random.default_rng(1))
    on_right = np.asarray(pairs.trials.left) > np.asarray(pairs.trials.right)

    decided = tests.exact(answers)

    assert tests.by_model == (by_model,)
    for study, given in enumerate(answers.astype(int)):
        sided = SidedAnswers(
            responses=3 + np.where(on_right, given, -given),
            on_right=on_right,
            participants=people,
            segments=segments,
        )
        alone = net_preference(sided) if by_model else clustered_mean(sided.wins, people, segments)
        assert decided.p_values[study, 0] == pytest.approx(alone.p_value)
        assert decided.signs[study, 0] == np.sign(sided.signed.sum())


def test_the_quick_tests_bias_is_corrected() -> None:
    rankings = part(RANKINGS, 15, 8)
    tests = DecidingTests(rankings)
    answers = simulate_answers(rankings, ALIKE, 0.6, 300, np.random.default_rng(9))
    exact = tests.exact(answers)
    plain = float(np.mean(holm_rows(exact.p_values)[:, :2] < 0.05))

    result = simulate_power((rankings,), ALIKE, 0.6, Effort(quick=600, exact=100), (4,))[0]

    assert result.modelled >= 40
    assert result.power == pytest.approx(plain, abs=3 * np.hypot(result.error, 0.03))


POWERS = {
    0.2: ((25, 24, 0.20), (50, 24, 0.31), (100, 24, 0.41), (25, 48, 0.25)),
    0.4: ((25, 24, 0.64), (50, 24, 0.82), (25, 48, 0.76)),
    0.6: ((25, 24, 0.93), (50, 24, 0.99), (25, 48, 0.99)),
}
"""By effect: participants, items and the power of a crossed linear mixed model of scores."""


@pytest.mark.slow
@pytest.mark.parametrize("effect", POWERS)
def test_the_power_of_scores_is_near_that_of_a_crossed_mixed_model(
    effect: float,
) -> None:
    for participants, items, known in POWERS[effect]:
        tests = DecidingTests(part(PAIRS, participants, items))
        drawn = simulate_answers(tests.part, Opinions(), effect, 2000, np.random.default_rng(1))
        result = tests.quick(drawn)

        assert np.mean((result.p_values < 0.05) & (result.signs > 0)) == pytest.approx(
            known, abs=0.05
        )


@pytest.mark.parametrize(
    "sketch",
    [replace(PAIRS, questions=2), RATINGS, replace(RANKINGS, questions=2)],
    ids=lambda sketch: sketch.kind,
)
def test_changed_simulations_require_a_new_version(sketch: Sketch) -> None:
    task = Task(
        size=sketch.size(20, 20, excluded=0.0),
        effect=0.5,
        opinions=Opinions(),
        effort=Effort(quick=100, exact=20),
        seed=3,
    )
    (result,) = simulate_cell(task)
    assert [result.power, result.alone, result.uncorrected, result.error] == pytest.approx(
        POWERS_OF_VERSION[grid.VERSION][sketch.kind], abs=1e-6
    )


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
    tested = BlockTests(p_values=np.zeros((2, 2)), signs=np.array([[1.0, 1.0], [-1.0, 1.0]]))
    decided = np.ones((2, 2))

    assert detection_shares(tested, decided, (True, False), effect=0.4).tolist() == [1.0, 0.0]
    assert detection_shares(tested, decided, (True, False), effect=0.0).tolist() == [1.0, 1.0]
