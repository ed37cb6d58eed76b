"""The analysis finds the true values of the raters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis.answers.participants import leave_out
from analysis.results.net_preference import sided
from analysis.results.preference import win_share
from analysis.stats.clustered_mean import Estimate
from benchmarks.rehearsal_recovery import simulated
from motion.segment import EMOTIONS
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.conditions import comparison_name
from tests.support.studies.made_study import make_segments

SEGMENTS = make_segments(EMOTIONS)


def reference_share(
    study: PairwiseStudy, answers: pd.DataFrame, about: str, question: str
) -> Estimate:
    """Return the win share of the reference in the comparison named `about`."""
    [other] = [o for o in study.others if comparison_name(study.reference, o) == about]
    own = answers[
        (answers["question"] == question)
        & ((answers["left"] == other) | (answers["right"] == other))
    ]
    of_reference = (own["right"] == study.reference).to_numpy(bool)
    return win_share(replace(sided(own), on_right=of_reference))


@pytest.mark.slow
def test_the_reports_intervals_have_their_stated_coverage(
    study: PairwiseStudy, population: Population
) -> None:
    rules = [rule.to_rule() for rule in study.settled_exclusions]
    held = []
    for seed in range(30):
        truth = expectations(study, SEGMENTS, population=population, seed=seed)
        assert len(truth) == len(study.others) * len(study.questions)
        made = simulated(study, SEGMENTS, population, seed)
        kept = leave_out(made.table, rules, known=made.known).analysed
        for entry in truth:
            share = reference_share(study, kept, entry.about, entry.question)
            held.append(share.low <= entry.value <= share.high)
    assert 0.92 <= np.mean(held) <= 0.99
