from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis.planning.part import THRESHOLDS
from analysis.results.net_preference import Expected, SidedAnswers, expected, net_preference
from benchmarks.validity.studies import Design, preferences

DESIGN = Design(participants=15, items=12, effect=0.4, participant_sd=0.6, item_sd=0.45)


def answers(seed: int, design: Design = DESIGN) -> SidedAnswers:
    study = preferences(design, np.random.default_rng(seed))
    return SidedAnswers(
        responses=study.responses.astype(np.int64),
        on_right=study.side > 0,
        participants=study.participants,
        segments=study.items,
    )


@pytest.fixture
def near() -> Expected:
    slight, clear = THRESHOLDS
    return expected(
        answers(0),
        thresholds=(-clear, -slight, slight, clear),
        effect=0.4,
        sd_participant=0.6,
        sd_segment=0.45,
    )


def test_fits_that_begin_nearby_find_the_same(near: Expected) -> None:
    for seed in range(1, 9):
        alone, begun = net_preference(answers(seed)), net_preference(answers(seed), near)

        assert begun.p_value == pytest.approx(alone.p_value, abs=2e-4)
        assert begun.log_likelihood == pytest.approx(alone.log_likelihood, abs=1e-4)
        assert begun.estimate == pytest.approx(alone.estimate, abs=0.005)
        assert np.isnan(begun.standard_error)


def test_a_beginning_of_other_answers_does_not_count(near: Expected) -> None:
    whole = answers(1)
    fewer = replace(whole, responses=np.clip(whole.responses, 2, 4))

    begun = net_preference(fewer, near)

    assert begun.p_value == pytest.approx(net_preference(fewer).p_value, abs=2e-4)
