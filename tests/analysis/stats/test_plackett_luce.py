from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from analysis.stats.strength_models import bradley_terry, plackett_luce
from tests.analysis.stats.named_votes import votes_of


def rankings(rows: list[tuple[int, str, str, int]]) -> pd.DataFrame:
    table = pd.DataFrame(rows, columns=["ranking", "participant", "condition", "rank"])
    return table.assign(segment="s")


def drawn(worths: dict[str, float], count: int, seed: int = 0) -> pd.DataFrame:
    """Rank by worth plus Gumbel noise, which is Plackett and Luce's model."""
    chance = np.random.default_rng(seed)
    rows = []
    for number in range(count):
        noisy = {name: worth + chance.gumbel() for name, worth in worths.items()}
        order = sorted(noisy, key=lambda name: -noisy[name])
        rows += [(number, f"P{number % 20}", name, order.index(name) + 1) for name in worths]
    return rankings(rows)


def test_it_finds_what_was_put_in() -> None:
    worths = {"a": 1.0, "b": 0.0, "c": -0.2, "d": -0.8}

    result = plackett_luce(drawn(worths, 800), tuple(worths))

    assert result.strengths == pytest.approx(list(worths.values()), abs=0.2)
    assert result.strengths.sum() == pytest.approx(0, abs=1e-9)
    assert (result.errors > 0).all()
    assert (result.n, result.participants) == (800, 20)


def test_of_two_conditions_with_ties_it_is_davidsons_model() -> None:
    left, right, outcome = ["a", "b", "a", "b", "c", "c"], ["b", "c", "c", "a", "a", "b"], []
    chance = np.random.default_rng(2)
    left, right = left * 40, right * 40
    outcome = [int(value) for value in chance.integers(-1, 2, len(left))]
    people = [f"P{number % 12}" for number in range(len(left))]
    segments = [f"s{number % 7}" for number in range(len(left))]
    rows = []
    for number, (first, second, won) in enumerate(zip(left, right, outcome, strict=True)):
        rows += [
            (number, people[number], first, 1 if won >= 0 else 2),
            (number, people[number], second, 1 if won <= 0 else 2),
        ]
    votes = votes_of(left, right, outcome, people, segment=segments)

    pairs = bradley_terry(votes, left_effect=False)
    ranked = plackett_luce(rankings(rows).assign(segment=np.repeat(segments, 2)), pairs.conditions)

    assert ranked.strengths == pytest.approx(pairs.strengths, abs=1e-8)
    assert ranked.errors == pytest.approx(pairs.errors, rel=1e-6)
    assert ranked.errors_two_way == pytest.approx(pairs.errors_two_way, rel=1e-3)
    assert ranked.ties[2] == pytest.approx(pairs.tie, abs=1e-8)
    assert ranked.log_likelihood == pytest.approx(pairs.log_likelihood)


def test_rankings_that_leave_conditions_out_count_for_those_they_hold() -> None:
    whole = drawn({"a": 0.8, "b": 0.0, "c": -0.8}, 300)
    partial = whole[~((whole["ranking"] % 3 == 0) & (whole["condition"] == "b"))]

    result = plackett_luce(partial, ("a", "b", "c"))

    assert not result.reason
    assert result.strengths[0] > result.strengths[1] > result.strengths[2]


def test_the_last_choice_of_one_says_nothing() -> None:
    two = rankings([(0, "P", "a", 1), (0, "P", "b", 2), (1, "Q", "b", 1), (1, "Q", "a", 2)])
    gaps = two.assign(rank=two["rank"] * 10)

    assert plackett_luce(two, "ab").log_likelihood == pytest.approx(2 * np.log(0.5))
    assert plackett_luce(gaps, "ab").log_likelihood == pytest.approx(2 * np.log(0.5))
