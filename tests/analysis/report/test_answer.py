from __future__ import annotations

import re

import numpy as np
import pytest

from analysis.report.answer import answer, figure_order, flow_line
from analysis.report.findings import find, verdict


def test_clear_differences_are_stated_with_their_direction(simulated_study):
    study = simulated_study(
        participants=25, segments=24, effects={"static": 1.6, "ground_truth": -1.6, "twin": 0.0}
    )
    inputs = study.inputs()
    findings = find(inputs)
    assert [verdict(p) for p in findings.preferences if p.question == "emotion"] == [
        "reference",
        "other",
        "undecided",
    ]
    emotion, synchronisation, basis = answer(inputs, findings)
    assert emotion.startswith(
        "On emotion, participants preferred rule based to static (win share of rule based ."
    )
    assert "; they preferred ground truth (" in emotion
    assert "; the answers do not decide between rule based and twin (" in emotion
    assert emotion.count("95% interval") == 1
    assert synchronisation.startswith("On synchronisation, ")
    analysed = findings.exclusion.sessions_analysed
    assert 60 <= analysed < 75
    assert f"{analysed} of 75 participants about 24 segments of 2 speakers" in basis


def test_several_undecided_comparisons_are_set_against_the_reference_one_by_one(simulated_study):
    study = simulated_study(participants=8, segments=8, effects={"twin": 0.0, "double": 0.0})
    inputs = study.inputs()
    assert re.fullmatch(
        r"On emotion, the answers do not decide between rule based and either of twin \(win share "
        r"of rule based \S+, 95% interval [^)]+\) and double \([^)]+\)\.",
        answer(inputs, find(inputs))[0],
    )


@pytest.mark.parametrize(("value", "share"), [(-1, "1.00"), (0, ".50"), (2, ".00")])
def test_what_cannot_be_tested_is_not_called_undecided(simulated_study, value, share):
    study = simulated_study(
        participants=3, segments=4, effects={"static": 1.0}, inattentive=0, unfinished=0
    )
    responses = study.responses()
    main = responses["kind"] != "catch"
    on_left = responses["left_condition"] == responses["reference"]
    responses.loc[main, "value"] = np.where(on_left, value, -value)[main]
    inputs = study.inputs(responses=responses)
    findings = find(inputs)
    assert {verdict(p) for p in findings.preferences} == {"untested"}
    assert answer(inputs, findings)[0] == (
        f"On emotion, there is no test of rule based against static (win share of rule based "
        f"{share}, all answers alike)."
    )


def test_emotion_comes_first_as_in_the_figure_it_follows(simulated_study):
    inputs = simulated_study(participants=2, segments=4).inputs()
    assert tuple(inputs.questions) == ("synchronisation", "emotion")
    assert figure_order(inputs) == ("emotion", "synchronisation")


def test_study_sessions_without_an_answer_stand_in_the_flow(simulated_study):
    study = simulated_study(participants=6, segments=8)
    inputs = study.inputs(study_sessions={"rule_based_vs_static": 9, "rule_based_vs_mismatched": 6})
    line = flow_line(inputs, find(inputs))
    assert line == (
        "Participants: 15 started, 12 answered − 2 unfinished − 6 failed more than 1 catch trial "
        "= 4 analysed."
    )


def test_conclusions_that_hang_on_exclusions_are_named(simulated_study):
    study = simulated_study(participants=20, segments=12, effects={"static": 0.75}, inattentive=9)
    inputs = study.inputs()
    findings = find(inputs)
    changed = [
        kept.question
        for kept, everyone in zip(findings.preferences, findings.everyone, strict=True)
        if verdict(kept) != verdict(everyone)
    ]
    assert changed
    named = answer(inputs, findings)[-1].split("the conclusion would differ for ")[1]
    assert named == " and ".join(f"static on {question}" for question in changed) + "."
