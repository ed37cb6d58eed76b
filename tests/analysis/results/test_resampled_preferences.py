"""Answers as sums, and what resamples of them prefer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

from analysis.answers.table import ANALYSED_KINDS
from analysis.results.resampled_preferences import (
    PSEUDO_VOTES,
    fit_strengths_of_tables,
    resample_preferences,
    tally,
)
from tests.analysis.results.made_tables import TABLES, read_table
from tests.analysis.results.simulated_studies import AgreeingStudy


@pytest.fixture
def answers() -> pd.DataFrame:
    return AgreeingStudy(conditions=3).drawn(np.random.default_rng(1))[0]


def test_estimates_are_the_means(answers: pd.DataFrame) -> None:
    result = resample_preferences(tally("rating", answers), resamples=10, seed=0)
    means = answers.groupby("condition", observed=True)["value"].mean()
    assert result.estimates == pytest.approx(means.to_numpy())


def test_resamples_are_those_of_the_two_way_bootstrap(answers: pd.DataFrame) -> None:
    one = answers[answers["condition"] == "c01"]
    table = one.pivot(index="participant", columns="segment", values="value").to_numpy()
    chance = np.random.default_rng(4)
    people, things = chance.integers(20, size=(500, 20)), chance.integers(12, size=(500, 12))
    expected = [table[np.ix_(p, t)].mean() for p, t in zip(people, things, strict=True)]
    result = resample_preferences(tally("rating", answers), resamples=500, seed=4)
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


def test_a_condition_that_always_wins_is_strong_but_finite() -> None:
    wins = np.array([[0, 500.0, 500], [0, 0, 300], [0, 200, 0]])
    result = fit_strengths_of_tables(wins[None])[0]
    assert np.isfinite(result).all()
    assert result[0] > result[1] > result[2]
    assert result.sum() == pytest.approx(0)


def test_conditions_that_no_comparison_connects_have_no_strengths() -> None:
    apart = np.zeros((2, 4, 4))
    apart[:, 0, 1] = apart[:, 2, 3] = 5
    apart[1, 1, 2] = 1
    result = fit_strengths_of_tables(apart)
    assert np.isnan(result[0]).all()
    assert np.isfinite(result[1]).all()


def _answers(protocol: str, rows: pd.DataFrame, folder: Path) -> pd.DataFrame:
    table = read_table(rows, protocol, folder)
    return table.shown[table.shown["kind"].isin(ANALYSED_KINDS)].reset_index(drop=True)


@pytest.mark.parametrize("protocol", TABLES)
def test_every_answer_is_counted_once(protocol: str, tmp_path: Path) -> None:
    answers = _answers(protocol, TABLES[protocol](), tmp_path)
    result = tally(protocol, answers)
    assert result.cells[1].sum() == len(answers)
    assert result.participants == answers["participant"].nunique()
    assert set(result.segments) == set(answers["segment"])


def test_a_win_counts_for_the_first_of_a_pair_wherever_it_stood(tmp_path: Path) -> None:
    rows = pd.DataFrame(
        [
            ("p1", "s1", "q", "x", "y", 1),
            ("p1", "s2", "q", "y", "x", 5),
            ("p2", "s1", "q", "x", "y", 3),
            ("p2", "s2", "q", "y", "x", 2),
        ],
        columns=["participant", "segment", "question", "left", "right", "response"],
    )
    result = tally("pairwise", _answers("pairwise", rows, tmp_path))
    sums, counts = result.cells
    first = result.conditions[result.groups[0, 0]]
    share = sums.sum() / counts.sum()
    assert share == pytest.approx(2.5 / 4 if first == "x" else 1.5 / 4)


def test_own_speech_wins_wherever_it_was_heard(tmp_path: Path) -> None:
    rows = pd.DataFrame(
        [
            ("p1", "s1", "q", "x", "own", "other", 1),
            ("p1", "s2", "q", "x", "other", "own", 5),
            ("p2", "s1", "q", "x", "other", "own", 1),
        ],
        columns=[
            *("participant", "segment", "question", "condition"),
            *("left_speech", "right_speech", "response"),
        ],
    )
    result = tally("mismatch", _answers("mismatch", rows, tmp_path))
    assert result.cells[0].sum() == 2


def test_tied_ranks_share_their_places_and_the_best_is_highest(tmp_path: Path) -> None:
    rows = pd.DataFrame(
        [("p1", "s1", "q", "x", 1), ("p1", "s1", "q", "y", 2), ("p1", "s1", "q", "z", 2)],
        columns=["participant", "segment", "question", "condition", "rank"],
    )
    result = tally("ranking", _answers("ranking", rows, tmp_path))
    by_condition = dict(zip(result.conditions, result.cells[0].ravel(), strict=True))
    assert by_condition == {"x": -1.0, "y": -2.5, "z": -2.5}


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
