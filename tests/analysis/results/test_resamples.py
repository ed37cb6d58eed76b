import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import minimize

from analysis.metrics.scores import Better, StudyMetrics
from analysis.results.against_people import WithinCorrelation, within_conditions
from analysis.results.resamples import (
    ITSELF,
    NOT_MEASURED,
    NOTHING_RECORDED,
    oriented_metrics,
    resample_preferences,
    tally,
)
from analysis.stats.strength_models import PSEUDO_VOTES, fit_strengths_of_tables
from tests.analysis.results.made_tables import read_table
from tests.analysis.results.simulated_studies import AgreeingStudy, metrics_of, names


@pytest.mark.parametrize("full", [0.0, 1.0])
def test_resamples_are_those_of_the_two_way_bootstrap_and_estimates_the_means(
    monkeypatch: pytest.MonkeyPatch, full: float
) -> None:
    monkeypatch.setattr("analysis.results.resamples.FULL", full)
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


def test_strengths_maximise_the_likelihood() -> None:
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
        # A segment that was ranked twice has two orders.
        (
            "ranking",
            ("condition", "rank", "trial"),
            [("x", 1, "1"), ("y", 2, "1"), ("x", 2, "2"), ("y", 1, "2")],
            [-3, -3],
        ),
    ],
)
def test_answers_are_summed_by_preferred_condition_on_either_side(
    protocol: str, columns: tuple[str, ...], rows: list[object], sums: list[float], tmp_path: Path
) -> None:
    table = pd.DataFrame(rows, columns=columns).assign(participant="p", segment="s", question="q")

    result = tally(protocol, read_table(table, protocol, tmp_path).shown)

    assert result.cells[0].ravel().tolist() == sums
    assert result.cells[1].sum() == len(rows)


SCORES = np.array([[1.0, 3.0], [4.0, 6.0], [math.nan, 2.0]])

NAMES = ("c00", "c01", "c02")

SEGMENTS = ("s00", "s01")


def _within(
    answers: pd.DataFrame, metrics: StudyMetrics, protocol: str = "rating"
) -> WithinCorrelation:
    result = tally(protocol, answers)
    (side,) = oriented_metrics(metrics, result.conditions, result.segments, None)
    return within_conditions(result, side)


def test_within_conditions_deviations_from_the_mean_are_correlated() -> None:
    answers, metrics = AgreeingStudy(within=0.6).drawn(np.random.default_rng(1))
    result = _within(answers, metrics)
    rows = answers.groupby(["condition", "segment"], observed=True)["value"].mean().reset_index()
    rows["score"] = [clip.result.value for clip in metrics.clips]
    rows["value"] -= rows.groupby("condition", observed=True)["value"].transform("mean")
    rows["score"] -= rows.groupby("condition", observed=True)["score"].transform("mean")
    assert result.estimate == pytest.approx(rows["value"].corr(rows["score"]))
    assert result.low < result.estimate < result.high
    assert (result.cells, result.segments, result.answers) == (72, 12, 1440)


def test_for_pairs_the_difference_of_scores_is_compared_with_the_win_share() -> None:
    chance = np.random.default_rng(5)
    scores = chance.normal(size=(2, 10))
    wins = scores[0] - scores[1] > np.median(scores[0] - scores[1])
    answers = pd.DataFrame(
        {
            "participant": pd.Categorical(["p"] * 10),
            "segment": pd.Categorical(names("s", 10)),
            "left": pd.Categorical(["c00"] * 10, names("c", 2)),
            "right": pd.Categorical(["c01"] * 10, names("c", 2)),
            "value": np.where(wins, 1, 5),
        }
    )
    expected = np.corrcoef(scores[0] - scores[1], wins)[0, 1]
    result = _within(answers, metrics_of(scores), "pairwise")
    assert result.estimate == pytest.approx(expected)


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
def test_a_missing_correlation_or_interval_has_a_reason(
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
    ("better", "whole", "of_the_first", "of_the_second"),
    [
        ("higher", [2, 5, 2], [1, 4, math.nan], [3, 6, 2]),
        ("lower", [-2, -5, -2], [-1, -4, math.nan], [-3, -6, -2]),
        # Of recorded motion, the second condition, nearness to itself says nothing.
        ("near the reference", [-3, -3], [-3, math.nan], [-3, -4]),
    ],
)
def test_scores_in_a_resample_are_means_of_its_segments(
    better: Better, whole: list[float], of_the_first: list[float], of_the_second: list[float]
) -> None:
    (metric,) = oriented_metrics(metrics_of(SCORES, better=better), NAMES, SEGMENTS, "c01")
    draws = np.array([[1.0, 1.0], [2.0, 0.0], [0.0, 2.0]])
    expected = np.array([whole, of_the_first, of_the_second])
    assert metric.resampled(draws) == pytest.approx(expected, nan_ok=True)
    # A score of whole conditions stays in every resample.
    without_clips = replace(metrics_of(SCORES, better=better), clips=())
    (metric,) = oriented_metrics(without_clips, NAMES, SEGMENTS, "c01")
    assert metric.resampled(draws).tolist() == [whole] * 3


UNSCORED = np.array([[1.0, 3.0], [math.nan, math.nan]])


@pytest.mark.parametrize(
    ("scores", "recorded", "left_out"),
    [
        (SCORES, "c01", {1: ITSELF}),
        (SCORES, None, dict.fromkeys(range(3), NOTHING_RECORDED)),
        (UNSCORED, "c00", {0: ITSELF, 1: "too short (2 of 2 clips)", 2: NOT_MEASURED}),
    ],
)
def test_a_condition_without_a_usable_score_says_why(
    scores: np.ndarray, recorded: str | None, left_out: dict[int, str]
) -> None:
    metrics = metrics_of(scores, better="near the reference")
    (metric,) = oriented_metrics(metrics, NAMES, SEGMENTS, recorded)
    assert metric.left_out == left_out
