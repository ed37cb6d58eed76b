"""The analysis finds what the raters were given to prefer."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np
import pandas as pd
import pytest

from analysis.exclusions.study_sessions import ExclusionResult, exclude, failed_catch_trials
from analysis.preferences.win_share import Preference, compare
from analysis.responses import responses_frame
from motion.segment import EMOTIONS, Segment
from studyapp.definition.protocols.pairwise import PairwiseStudy, comparison_name
from studyapp.rehearsal.judgement import judge
from studyapp.rehearsal.population import Population
from studyapp.rehearsal.raters import Rater
from studyapp.rehearsal.sight import SeenTrial
from studyapp.rehearsal.truth import expectations
from tests.studyapp.made_study import pair_plan

NOON = datetime(2026, 1, 1, 12, tzinfo=UTC)
SEGMENTS = tuple(
    Segment(name=emotion, wav="a.wav", start=0, end=5, speaker="a", emotion=emotion)
    for emotion in EMOTIONS
)


def simulated(study: PairwiseStudy, population: Population, seed: int) -> pd.DataFrame:
    """Return what a rehearsal of `study` stores, without the server in between."""
    rows = []
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
                catch = trial.kind == "catch"
                rows.extend(
                    {
                        "study_session": rater.name,
                        "comparison": comparison,
                        "reference": study.catch_against if catch else study.reference,
                        "other": study.catch.condition if catch else other,
                        "segment": trial.segment.name,
                        "emotion": trial.segment.emotion,
                        "speaker": trial.segment.speaker,
                        "kind": trial.kind,
                        "position": trial.position,
                        "question": question.name,
                        "left_condition": left,
                        "right_condition": right,
                        "value": given[question.name, None],
                        "expected": {None: "", 1: "left", 2: "right"}[trial.expected],
                        "seconds": 1.0,
                        "watched": 1.0,
                        "answered_at": NOON,
                    }
                    for question in study.questions
                )
    return responses_frame(rows)


def analysed(
    study: PairwiseStudy, responses: pd.DataFrame
) -> tuple[ExclusionResult, list[Preference]]:
    kept = exclude(responses, [failed_catch_trials(study.catch.max_failed)])
    pairs = [(comparison_name(study.reference, o), study.reference, o) for o in study.others]
    questions = [question.name for question in study.questions]
    return kept, list(compare(kept.analysed, pairs, questions))


@pytest.mark.slow
def test_the_intervals_of_the_report_hold_the_truth_as_often_as_they_claim(
    study: PairwiseStudy, population: Population
) -> None:
    held = []
    for seed in range(30):
        truth = expectations(study, SEGMENTS, population=population, seed=seed)
        _, found = analysed(study, simulated(study, population, seed))
        for entry, preference in zip(truth, found, strict=True):
            assert (entry.about, entry.question) == (
                preference.comparison,
                preference.question,
            )
            share = preference.win_share
            held.append(share.low <= entry.value <= share.high)
    assert 0.92 <= np.mean(held) <= 0.99


def test_catch_trials_tell_inattentive_raters_from_attentive_ones(
    study: PairwiseStudy, population: Population
) -> None:
    kept, _ = analysed(study, simulated(study, population, 1))
    excluded = {exclusion.study_session for exclusion in kept.exclusions}
    names = [
        f"{comparison_name(study.reference, other)} {number}"
        for other in study.others
        for number in range(study.participants_per_comparison)
    ]
    inattentive = {
        name for name in names if not Rater(population=population, seed=1, name=name).attentive
    }
    assert inattentive
    assert len(excluded ^ inattentive) <= 0.04 * len(names)
