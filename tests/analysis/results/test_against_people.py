from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from analysis.measurement.scores import StudyMetrics
from analysis.results.against_people import against_people
from analysis.results.report import as_json
from tests.analysis.results.simulated_studies import AgreeingStudy


def _study(**settings: Any) -> tuple[pd.DataFrame, StudyMetrics]:
    return AgreeingStudy(**settings).drawn(np.random.default_rng(1))


def test_a_metric_that_orders_conditions_as_people_do_agrees_entirely() -> None:
    answers, metrics = _study(tau=1.0, noise=0.0, within=1.0)
    (result,) = against_people("rating", answers, metrics, resamples=100).metrics
    assert result.kendall.estimate == result.spearman.estimate == 1
    assert result.kendall.low < 1
    assert result.kendall.high == 1
    assert result.within.estimate == pytest.approx(1)


def test_two_conditions_have_no_correlation_and_three_no_interval() -> None:
    two, three = (
        against_people("rating", *_study(conditions=count), resamples=50) for count in (2, 3)
    )
    assert math.isnan(two.metrics[0].kendall.estimate)
    assert two.metrics[0].kendall.reason == "2 conditions have scores and answers; it takes 3"
    assert two.sampling_range is None
    assert abs(three.metrics[0].kendall.estimate) <= 1
    assert math.isnan(three.metrics[0].kendall.low)
    assert three.metrics[0].kendall.reason == "3 conditions are too few for an interval"


def test_one_participant_gives_no_interval_and_says_so() -> None:
    result = against_people("rating", *_study(participants=1), resamples=50).metrics[0]
    assert math.isnan(result.kendall.low)
    assert result.kendall.reason.startswith("one participant")
    assert math.isnan(result.places[0].low)


def test_answers_that_are_all_alike_give_no_correlation() -> None:
    answers, metrics = _study()
    result = against_people("rating", answers.assign(value=3.0), metrics, resamples=50).metrics[0]
    assert result.kendall.reason == "all conditions are equal in the metric or in the answers"
    assert "do not differ" in result.within.reason


def test_resamples_without_a_correlation_are_counted() -> None:
    result = against_people("rating", *_study(conditions=4), resamples=2000).metrics[0]
    # All four draws are one condition with a chance of 4 in 4⁴.
    assert 10 < result.kendall.degenerate < 60


def test_one_seed_gives_one_result_with_a_reason_for_every_missing_number() -> None:
    study = _study(conditions=3)
    texts = [as_json(against_people("rating", *study, resamples=50)) for _ in range(2)]
    assert texts[0] == texts[1]
    assert '"low": null' in texts[0]


@pytest.mark.slow
def test_intervals_contain_the_truth_at_least_as_often_as_they_say() -> None:
    """Also where six conditions are few, and their scores and answers noisy."""
    study = AgreeingStudy(conditions=6, tau=0.5, within=0.3)
    truth = 0.3 * math.sqrt(0.25 / (0.25 + study.noise**2 / study.participants))
    chance = np.random.default_rng(11)
    over, within = [], []
    for _ in range(60):
        result = against_people("rating", *study.drawn(chance), resamples=200).metrics[0]
        over.append(result.kendall.low <= study.tau <= result.kendall.high)
        within.append(result.within.low <= truth <= result.within.high)
    assert np.mean(over) >= 0.93
    # 88 of 100 is what 93 of 100 may come to in 60 studies.
    assert np.mean(within) >= 0.88
