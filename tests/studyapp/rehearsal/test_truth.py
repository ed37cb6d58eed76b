"""The true values of a rehearsal are what its raters say on average, and what analysis finds."""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np
import pytest

from studyapp.rehearsal.simulation.population import Population
from studyapp.rehearsal.simulation.raters import Rater, judge
from studyapp.rehearsal.simulation.truth import expectations
from studyapp.study.design.trial import AnswerKey, PlannedTrial
from studyapp.study.settings.conditions import comparison_name
from studyapp.study.settings.reading import parse_study
from studyapp.study.settings.study import Study
from tests.support.studies.made_study import make_segments

CONDITIONS = ("ours", "theirs", "real")
SEGMENTS = make_segments(["anger"] * 3)
PEOPLE = Population(
    quality={"ours": {"q": 0.8}, "theirs": {"q": 0.0}, "real": {"q": 1.6}},
    belonging={"ours": {"q": 1.0}, "theirs": {"q": 0.0}, "real": {"q": 2.0}},
    kinds={},
)
PART = {"name": "all", "conditions": CONDITIONS}
QUESTION = {"name": "q", "title": "Q", "text": "?"}
STUDIES: dict[str, dict[str, object]] = {
    "pairs": {"reference": "ours", "comparisons": "all_pairs", "layout": "players", "practice": 0},
    "opinions": {"sets": [PART], "questions": [QUESTION | {"scale": "mean_opinion"}]},
    "sliders": {"sets": [PART], "questions": [QUESTION | {"scale": "slider"}]},
    "ranks": {"blocks": [PART]},
    "forced choice": {"fit": 3, "realism": 3, "questions": [QUESTION | {"levels": 2}]},
    "choice with ties": {"fit": 3, "realism": 3, "questions": [QUESTION | {"levels": 3}]},
}
PROTOCOLS = ("pairwise", "rating", "rating", "ranking", "mismatch", "mismatch")
PLACES = 60
RATERS = 700


def made(protocol: str, **keys: object) -> Study:
    common: dict[str, object] = {
        "name": "made",
        "title": "Made",
        "protocol": protocol,
        "conditions": {name: {"videos": True} for name in CONDITIONS},
        "catch": {"trials": 0},
        "questions": [QUESTION],
        "page": {"consent": "You agree."},
    }
    return parse_study(common | keys, where="test")


def score(trial: PlannedTrial, key: AnswerKey, value: int) -> tuple[str, float]:
    """Return the subject of an answer, and its value."""
    if key[1] is not None:
        return trial.conditions[key[1] - 1], float(value)
    first, second = trial.stimuli
    share = (np.sign(value) + 1) / 2
    if first.condition == second.condition:
        return first.condition, share if second.speech == second.segment else 1 - share
    a, b = sorted(trial.conditions, key=CONDITIONS.index)
    return comparison_name(a, b), share if second.condition == a else 1 - share


def plans_of(study: Study) -> list[Sequence[PlannedTrial]]:
    return [study.plan(study.arms[0], number, SEGMENTS) for number in range(PLACES)]


def said(
    study: Study, plans: Sequence[Sequence[PlannedTrial]], *, seed: int, raters: int
) -> Mapping[tuple[str, str], Sequence[float]]:
    """Return what counts for each part and each of what it is about, rater after rater."""
    found: dict[tuple[str, str], list[float]] = defaultdict(list)
    for number in range(raters):
        rater = Rater(population=PEOPLE, seed=seed, name=str(number))
        for trial in plans[number % PLACES]:
            for key, value in judge(study, rater, trial).values.items():
                about, counts = score(trial, key, value)
                found[trial.part, about].append(counts)
    return found


@pytest.mark.parametrize(
    ("protocol", "keys"), [*zip(PROTOCOLS, STUDIES.values(), strict=True)], ids=STUDIES
)
def test_many_raters_approach_the_true_value_on_these_segments(
    protocol: str, keys: dict[str, object]
) -> None:
    study = made(protocol, **keys)
    truth = expectations(study, SEGMENTS, population=PEOPLE, seed=3)
    found = said(study, plans_of(study), seed=3, raters=RATERS)

    assert {(known.part, known.about) for known in truth} == found.keys()
    for known in truth:
        counted = found[known.part, known.about]
        error = np.std(counted) / math.sqrt(RATERS)
        assert abs(np.mean(counted) - known.on_these_segments) < 3 * error, known.about


def test_many_studies_approach_the_true_value_over_all_segments() -> None:
    study = made("pairwise", **STUDIES["pairs"])
    plans = plans_of(study)
    counted = [
        np.mean(said(study, plans, seed=seed, raters=6)["", "ours-theirs"]) for seed in range(500)
    ]
    (known, *_) = expectations(study, SEGMENTS, population=PEOPLE, seed=0)

    error = np.std(counted) / math.sqrt(len(counted))
    assert known.about == "ours-theirs"
    assert abs(np.mean(counted) - known.value) < 3 * error
