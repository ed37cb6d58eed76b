from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

from analysis.metrics.scores import Better, ConditionScore, StudyMetrics
from analysis.results.against_people import WithinCorrelation, within_conditions
from analysis.results.resamples import (
    ITSELF,
    NOTHING_RECORDED,
    oriented_metrics,
    resample_preferences,
    tally,
)
from analysis.stats.strength_models import PSEUDO_VOTES, fit_strengths_of_tables
from tests.analysis.results.made_tables import read_table
from tests.analysis.results.simulated_studies import AgreeingStudy, metrics_of, names


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


SCORES = np.array([[1.0, 3.0], [4.0, 6.0], [math.nan, 2.0]])

NAMES = ("c00", "c01", "c02")

SEGMENTS = ("s00", "s01")


def _within(answers: pd.DataFrame, metrics: StudyMetrics) -> WithinCorrelation:
    result = tally("rating", answers)
    (side,) = oriented_metrics(metrics, result.conditions, result.segments, None)
    return within_conditions(result, side)


def test_within_conditions_what_is_left_without_their_means_is_correlated() -> None:
    answers, metrics = AgreeingStudy(within=0.6).drawn(np.random.default_rng(1))
    result = _within(answers, metrics)
    rows = answers.groupby(["condition", "segment"], observed=True)["value"].mean().reset_index()
    rows["score"] = [clip.result.value for clip in metrics.clips]
    rows["value"] -= rows.groupby("condition", observed=True)["value"].transform("mean")
    rows["score"] -= rows.groupby("condition", observed=True)["score"].transform("mean")
    assert result.estimate == pytest.approx(rows["value"].corr(rows["score"]))
    assert result.low < result.estimate < result.high
    assert (result.cells, result.segments, result.answers) == (72, 12, 1440)


def test_of_pairs_the_difference_of_scores_is_set_beside_the_win_share() -> None:
    chance = np.random.default_rng(5)
    scores = chance.normal(size=(2, 10))
    wins = scores[0] - scores[1] > np.median(scores[0] - scores[1])
    codes = np.arange(10)
    answers = pd.DataFrame(
        {
            "participant": pd.Categorical(["p"] * 10),
            "segment": pd.Categorical.from_codes(codes, pd.Index(names("s", 10))),
            "left": pd.Categorical.from_codes(np.zeros(10, int), pd.Index(names("c", 2))),
            "right": pd.Categorical.from_codes(np.ones(10, int), pd.Index(names("c", 2))),
            "value": np.where(wins, 1, 5),
        }
    )
    result = tally("pairwise", answers)
    (side,) = oriented_metrics(metrics_of(scores), result.conditions, result.segments, None)
    expected = np.corrcoef(scores[0] - scores[1], wins)[0, 1]
    assert within_conditions(result, side).estimate == pytest.approx(expected)


ALIKE = metrics_of(np.full((6, 12), 0.1))


@pytest.mark.parametrize(
    ("segments", "change", "scores", "has_estimate", "reason"),
    [
        (12, {"value": 0.1}, None, False, "the answers do not differ within conditions"),
        (12, {}, ALIKE, False, "the scores do not differ within conditions"),
        (1, {}, None, False, "fewer than two segments have scores and answers"),
        (4, {}, None, True, "4 segments are too few for an interval"),
    ],
)
def test_without_a_correlation_or_an_interval_the_reason_is_given(
    segments: int,
    change: dict[str, float],
    scores: StudyMetrics | None,
    has_estimate: bool,
    reason: str,
) -> None:
    answers, metrics = AgreeingStudy(segments=segments).drawn(np.random.default_rng(1))
    result = _within(answers.assign(**change), scores or metrics)
    assert math.isnan(result.estimate) != has_estimate
    assert math.isnan(result.low)
    assert result.reason == reason


@pytest.mark.parametrize(
    ("better", "oriented"),
    [("higher", [2, 5, 2]), ("lower", [-2, -5, -2]), ("near the reference", [-3, -3])],
)
def test_higher_oriented_scores_are_always_better(better: Better, oriented: list[float]) -> None:
    (result,) = oriented_metrics(metrics_of(SCORES, better=better), NAMES, SEGMENTS, "c01")
    assert result.resampled(np.ones((1, 2)))[0] == pytest.approx(oriented)


def test_recorded_motion_is_not_correlated_where_nearness_to_it_counts() -> None:
    metrics = metrics_of(SCORES, better="near the reference")
    (result,) = oriented_metrics(metrics, NAMES, SEGMENTS, "c01")
    (without,) = oriented_metrics(metrics, NAMES, SEGMENTS, None)
    assert result.left_out == {1: ITSELF}
    assert result.recorded == 5
    assert set(without.left_out.values()) == {NOTHING_RECORDED}


def test_scores_of_a_resample_are_means_over_the_segments_drawn() -> None:
    (result,) = oriented_metrics(metrics_of(SCORES), NAMES, SEGMENTS, None)
    drawn = result.resampled(np.array([[2.0, 0.0], [0.0, 2.0]]))
    assert drawn[1] == pytest.approx([3, 6, 2])
    assert drawn[0, :2] == pytest.approx([1, 4])
    assert math.isnan(drawn[0, 2])


def test_a_condition_without_a_score_says_why() -> None:
    scores = np.array([[1.0, 3.0], [math.nan, math.nan]])
    (result,) = oriented_metrics(metrics_of(scores), NAMES, SEGMENTS, None)
    assert result.left_out == {1: "too short (2 of 2 clips)", 2: "the metric was not measured"}


def test_a_score_of_whole_conditions_stays_in_every_resample() -> None:
    whole = tuple(
        ConditionScore(
            condition=name,
            name="FGD",
            unit="",
            value=value,
            spread=math.nan,
            scored=2,
            clips=2,
            settings={},
            reason="",
            better="lower",
        )
        for name, value in (("c00", 3.0), ("c01", 1.0))
    )
    metrics = StudyMetrics(frame_rate=30.0, clips=(), conditions=whole)
    (result,) = oriented_metrics(metrics, NAMES[:2], SEGMENTS, None)
    assert result.resampled(np.array([[2.0, 0.0], [0.0, 2.0]])).tolist() == [[-3, -1], [-3, -1]]
