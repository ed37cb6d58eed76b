"""Simulated answers to trials as every protocol plans them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from studyapp.rehearsal.simulation.judgement import Judgement, judge
from studyapp.rehearsal.simulation.kinds import Kind
from studyapp.rehearsal.simulation.population import Population, default_population
from studyapp.rehearsal.simulation.raters import Rater
from studyapp.rehearsal.simulation.sight import SeenTrial
from studyapp.study.settings.reading import parse_text
from studyapp.study.settings.study import Study
from tests.studyapp.made_study import make_segments
from tests.studyapp.rehearsal.protocol_studies import definition

SEGMENTS = make_segments(["anger", "fear", "sadness"])
ATTENTIVE: dict[str, Any] = {"kinds": {}, "overlooked": 0.0}
STUDIES = {
    name: parse_text(definition(name, around=False), where="study.toml")
    for name in ("all pairs", "ratings", "rankings", "rankings with ties", "mismatch")
}
each_study = pytest.mark.parametrize("study", STUDIES.values(), ids=STUDIES.keys())


def judged(
    study: Study, raters: int = 40, **people: Any
) -> Iterator[tuple[Rater, SeenTrial, Judgement]]:
    """Yield what raters answer to all trials of their places."""
    population: Population = replace(default_population(study), **people)
    for number in range(raters):
        rater = Rater(population=population, seed=6, name=str(number))
        for planned in study.plan(study.arms[0], number % study.arms[0].places, SEGMENTS):
            trial = SeenTrial(
                position=planned.position,
                kind=planned.kind,
                part=planned.part,
                segment=planned.segment.name,
                stimuli=planned.stimuli,
                expected=planned.expected,
                instructed=planned.instructed,
            )
            yield rater, trial, judge(study, rater, trial)


@each_study
@pytest.mark.parametrize(
    "kind", ["attentive", "careless", "hasty", "side_biased", "straight_lining"]
)
def test_every_answer_is_one_that_the_study_takes(study: Study, kind: Kind) -> None:
    for _, trial, judgement in judged(study, kinds={kind: 1.0}):
        asks = study.asks(trial)
        assert set(judgement.values) == {ask.key for ask in asks}
        assert all(judgement.values[ask.key] in ask.values for ask in asks)
        assert not study.problem(trial, judgement.values)
        assert set(judgement.fields()) >= {ask.field for ask in asks}


@each_study
def test_the_same_rater_answers_the_same_trial_alike(study: Study) -> None:
    first = [judgement.fields() for _, _, judgement in judged(study)]
    assert first == [judgement.fields() for _, _, judgement in judged(study)]


@each_study
def test_attentive_raters_do_what_attention_checks_ask(study: Study) -> None:
    checks = [
        study.failed(trial, judgement.values)
        for _, trial, judgement in judged(study, **ATTENTIVE)
        if trial.instructed is not None
    ]
    assert not any(checks)


@each_study
def test_a_check_that_is_overlooked_is_answered_as_any_other_page(study: Study) -> None:
    checked = [
        (judgement.values, judge(study, rater, replace(trial, instructed=None)).values)
        for rater, trial, judgement in judged(study, kinds={}, overlooked=1.0)
        if trial.instructed is not None
    ]
    assert all(answered == ordinary for answered, ordinary in checked)


@pytest.mark.parametrize("protocol", ["all pairs", "ratings", "mismatch", "rankings with ties"])
@pytest.mark.parametrize("kind", ["careless", "hasty", "straight_lining"])
def test_unsound_raters_fail_some_attention_checks(protocol: str, kind: Kind) -> None:
    study = STUDIES[protocol]
    failed = [
        study.failed(trial, judgement.values)
        for _, trial, judgement in judged(study, kinds={kind: 1.0})
        if trial.instructed is not None
    ]
    assert sum(failed) > len(failed) / 10


@each_study
def test_who_answers_in_a_straight_line_always_says_the_same(study: Study) -> None:
    lines: dict[tuple[str, int, object], set[int]] = {}
    for rater, trial, judgement in judged(study, kinds={"straight_lining": 1.0}):
        for key, value in judgement.values.items():
            lines.setdefault((rater.name, len(trial.stimuli), key), set()).add(value)
    assert all(len(values) == 1 for values in lines.values())


@each_study
def test_who_is_side_biased_is_drawn_to_one_end_of_the_page(study: Study) -> None:
    """By the sum over raters of how far each leans, whichever way."""

    def leaning(kind: Kind) -> float:
        leans: dict[str, float] = {}
        for rater, trial, judgement in judged(study, kinds={kind: 1.0}):
            last = len(trial.stimuli)
            for (_, number), value in judgement.values.items():
                towards_last = value if number is None else {1: -value, last: value}.get(number, 0)
                leans[rater.name] = leans.get(rater.name, 0.0) + towards_last
        return sum(map(abs, leans.values()))

    assert leaning("side_biased") > 1.3 * leaning("attentive")


def test_who_is_hasty_sees_less_of_every_difference() -> None:
    study = STUDIES["all pairs"]
    right = {
        kind: [
            study.prefers(judgement.values, trial.expected, 3 - trial.expected)
            for _, trial, judgement in judged(study, kinds={kind: 1.0})
            if trial.expected is not None
        ]
        for kind in ("attentive", "hasty", "careless")
    }
    share = {kind: sum(found) / len(found) for kind, found in right.items()}
    assert share["attentive"] > share["hasty"] > share["careless"]


def test_reasons_are_ticked_as_often_as_the_population_says() -> None:
    ticked = [
        len(judgement.reasons[ask.key]) / len(ask.reasons)
        for _, _, judgement in judged(STUDIES["ratings"], 160, reasons=0.4)
        for ask in judgement.asks
        if ask.reasons
    ]
    assert sum(ticked) / len(ticked) == pytest.approx(0.4, abs=0.05)


def test_motion_is_preferred_with_its_own_speech_where_it_belongs_to_it() -> None:
    study = STUDIES["mismatch"]
    wins: dict[bool, list[bool]] = {True: [], False: []}
    people = default_population(study)
    strong = {name: {"better": 4.0 if name == "ours" else 0.0} for name in people.quality}
    for _, trial, judgement in judged(study, belonging=strong, **ATTENTIVE):
        if trial.part == "fit":
            own = next(n for n, s in enumerate(trial.stimuli) if s.speech == s.segment)
            value = judgement.values["better", None]
            wins[trial.conditions[0] == "ours"].append(value == (1 if own else -1))
    assert sum(wins[True]) > 0.8 * len(wins[True])
    assert sum(wins[False]) < 0.6 * len(wins[False])
