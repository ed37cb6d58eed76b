"""The analysis finds the true values of the raters."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analysis.answers.cells import Cells
from analysis.answers.reading import Order, answers_in
from analysis.answers.table import PAIRWISE, AnswerTable
from analysis.results.net_preference import sided
from analysis.results.participants import LeftOut, leave_out
from analysis.results.preference import win_share
from analysis.stats.clustered_mean import Estimate
from motion.segment import EMOTIONS, Segment
from studyapp.rehearsal.simulation.judgement import judge
from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, SeenTrial
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.protocols.pairwise import PairwiseStudy
from studyapp.study.settings.conditions import comparison_name
from tests.studyapp.made_study import pair_plan

SEGMENTS = tuple(
    Segment(name=emotion, wav="a.wav", start=0, end=5, speaker="a", emotion=emotion)
    for emotion in EMOTIONS
)


def simulated(study: PairwiseStudy, population: Population, seed: int) -> AnswerTable:
    """Return what a rehearsal of `study` stores, without the server in between."""
    rows: list[dict[str, object]] = []
    for other in study.others:
        comparison = comparison_name(study.reference, other)
        for number in range(study.participants_per_comparison):
            rater = Rater(population=population, seed=seed, name=f"{comparison} {number}")
            for trial in pair_plan(study, SEGMENTS, other=other, number=number):
                seen = SeenTrial(
                    position=trial.position, segment=trial.segment.name, stimuli=trial.stimuli
                )
                given = judge(study, rater, seen).values
                left, right = trial.conditions
                rows.extend(
                    {
                        "participant": rater.name,
                        "segment": trial.segment.name,
                        "question": question.name,
                        "trial": str(trial.position),
                        "kind": trial.kind,
                        "left": left,
                        "right": right,
                        "response": str(given[question.name, None] + 3),
                        "correct_side": {None: "", 1: "left", 2: "right"}[trial.expected],
                    }
                    for question in study.questions
                )
    cells = Cells(
        path=Path("answers.csv"),
        rows=pd.DataFrame(rows, dtype=str),
        numbers=pd.RangeIndex(len(rows)) + 2,
        ignored=(),
    )
    return answers_in(cells, PAIRWISE, Order(conditions=(study.reference, *study.others)))


def without_the_excluded(study: PairwiseStudy, table: AnswerTable) -> LeftOut:
    return leave_out(table, [rule.made() for rule in study.settled_exclusions])


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
def test_the_intervals_of_the_report_hold_the_truth_as_often_as_they_claim(
    study: PairwiseStudy, population: Population
) -> None:
    held = []
    for seed in range(30):
        truth = expectations(study, SEGMENTS, population=population, seed=seed)
        assert len(truth) == len(study.others) * len(study.questions)
        kept = without_the_excluded(study, simulated(study, population, seed)).analysed
        for entry in truth:
            share = reference_share(study, kept, entry.about, entry.question)
            held.append(share.low <= entry.value <= share.high)
    assert 0.92 <= np.mean(held) <= 0.99


def test_catch_trials_tell_careless_raters_from_attentive_ones(
    study: PairwiseStudy, population: Population
) -> None:
    people = replace(population, kinds={"careless": 0.08})
    excluded = set(without_the_excluded(study, simulated(study, people, 1)).exclusions)
    names = [
        f"{comparison_name(study.reference, other)} {number}"
        for other in study.others
        for number in range(study.participants_per_comparison)
    ]
    careless = {
        name for name in names if Rater(population=people, seed=1, name=name).kind == "careless"
    }
    assert careless
    assert len(excluded ^ careless) <= 0.04 * len(names)
