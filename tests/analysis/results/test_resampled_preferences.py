"""Answers as sums, and what resamples of them prefer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

from analysis.results.resamples import resample_preferences, tally
from analysis.stats.strength_models import PSEUDO_VOTES, fit_strengths_of_tables
from tests.analysis.results.made_tables import read_table
from tests.analysis.results.simulated_studies import AgreeingStudy


def test_resamples_are_those_of_the_two_way_bootstrap_and_estimates_the_means() -> None:
    answers, _ = AgreeingStudy(conditions=3).drawn(np.random.default_rng(1))
    one = answers[answers["condition"] == "c01"]
    table = one.pivot(index="participant", columns="segment", values="value").to_numpy()
    chance = np.random.default_rng(4)
    people, things = chance.integers(20, size=(500, 20)), chance.integers(12, size=(500, 12))
    expected = [table[np.ix_(p, t)].mean() for p, t in zip(people, things, strict=True)]

    result = resample_preferences(tally("rating", answers), resamples=500, seed=4)

    assert result.estimates[1] == pytest.approx(table.mean())
    assert result.draws[:, 1] == pytest.approx(expected)
    assert result.segments.sum(axis=1) == pytest.approx(12)


def test_strengths_have_the_greatest_likelihood() -> None:
    chance = np.random.default_rng(3)
    wins = chance.integers(1, 30, (4, 4)).astype(float)
    np.fill_diagonal(wins, 0)
    padded = wins + PSEUDO_VOTES * (1 - np.eye(4))

    def loss(strengths: np.ndarray) -> float:
        apart = strengths[:, None] - strengths[None]
        return float((padded * np.logaddexp(0, -apart)).sum() + strengths.sum() ** 2)

    best = minimize(loss, np.zeros(4), tol=1e-12).x
    assert fit_strengths_of_tables(wins[None])[0] == pytest.approx(best, abs=1e-5)


def test_conditions_that_no_comparison_connects_have_no_strengths() -> None:
    apart = np.zeros((2, 4, 4))
    apart[:, 0, 1] = apart[:, 2, 3] = 5
    apart[1, 1, 2] = 1
    result = fit_strengths_of_tables(apart)
    assert np.isnan(result[0]).all()
    assert np.isfinite(result[1]).all()


SPEECHES = ("condition", "left_speech", "right_speech", "response")


@pytest.mark.parametrize(
    ("protocol", "columns", "rows", "sums"),
    [
        (
            "pairwise",
            ("left", "right", "response"),
            [("x", "y", 1), ("y", "x", 5), ("x", "y", 3), ("y", "x", 2)],
            [2.5],
        ),
        (
            "mismatch",
            SPEECHES,
            [("x", "own", "other", 1), ("x", "other", "own", 5), ("x", "other", "own", 1)],
            [2],
        ),
        # Tied ranks share their places, and the best is the highest.
        ("ranking", ("condition", "rank"), [("x", 1), ("y", 2), ("z", 2)], [-1, -2.5, -2.5]),
    ],
)
def test_answers_are_summed_for_what_they_favour_wherever_it_stood(
    protocol: str, columns: tuple[str, ...], rows: list[object], sums: list[float], tmp_path: Path
) -> None:
    table = pd.DataFrame(rows, columns=columns).assign(participant="p", segment="s", question="q")

    result = tally(protocol, read_table(table, protocol, tmp_path).shown)

    assert result.cells[0].ravel().tolist() == sums
    assert result.cells[1].sum() == len(rows)


def test_many_participants_are_kept_as_a_sparse_table() -> None:
    answers = pd.DataFrame(
        {
            "participant": pd.Categorical([f"p{n}" for n in range(200)]),
            "segment": pd.Categorical([f"s{n % 50}" for n in range(200)]),
            "condition": pd.Categorical([f"c{n % 3}" for n in range(200)]),
            "value": np.ones(200),
        }
    )
    result = tally("rating", answers)
    assert not isinstance(result.counts, np.ndarray)
    assert result.cells[1].sum() == 200
