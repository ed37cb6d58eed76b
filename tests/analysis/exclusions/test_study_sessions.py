from __future__ import annotations

import pytest

from analysis.exclusions.study_sessions import (
    count_failed_catch_trials,
    exclude,
    failed_attention_checks,
    failed_catch_trials,
    incomplete_sessions,
)
from analysis.responses import responses_frame


def catch(answer, session, position, values, expected="left"):
    """Return a catch trial's answers, one per question."""
    sides = ("ours", "broken") if expected == "left" else ("broken", "ours")
    return [
        answer(
            study_session=session,
            kind="catch",
            other="broken",
            left_condition=sides[0],
            right_condition=sides[1],
            expected=expected,
            position=position,
            question=question,
            value=value,
        )
        for question, value in zip(("synchronisation", "emotion"), values, strict=True)
    ]


@pytest.mark.parametrize(
    ("values", "expected", "failed"),
    [
        ((-1, -2), "left", 0),
        ((1, 2), "right", 0),
        ((-1, 0), "left", 1),
        ((0, 0), "left", 1),
        ((-2, 1), "left", 1),
        ((-2, -2), "right", 1),
    ],
)
def test_a_catch_trial_fails_once_when_any_question_lacks_the_right_preference(
    answer, values, expected, failed
):
    responses = responses_frame(catch(answer, "s1", 1, values, expected))
    assert count_failed_catch_trials(responses).to_dict() == {"s1": failed}


def test_failures_are_counted_per_trial_and_zero_without_catch_trials(answer):
    rows = [
        *catch(answer, "s1", 1, (0, 0)),
        *catch(answer, "s1", 2, (-1, -1)),
        *catch(answer, "s1", 3, (1, -1)),
        answer(study_session="s2"),
    ]
    assert count_failed_catch_trials(responses_frame(rows)).to_dict() == {"s1": 2, "s2": 0}


@pytest.mark.parametrize(("allowed", "removed"), [(0, ["s1", "s2"]), (1, ["s2"]), (2, [])])
def test_more_failures_than_allowed_exclude(answer, allowed, removed):
    rows = [
        *catch(answer, "s1", 1, (0, 0)),
        *catch(answer, "s2", 1, (0, 0)),
        *catch(answer, "s2", 2, (0, 0)),
        *catch(answer, "s3", 1, (-1, -1)),
    ]
    result = exclude(responses_frame(rows), [failed_catch_trials(allowed)])
    assert [e.study_session for e in result.exclusions] == removed


def test_rules_apply_in_order_and_the_flow_adds_up(simulated_study):
    study = simulated_study(participants=10, segments=6, practice=2, inattentive=2, unfinished=1)
    result = exclude(study.responses(), [incomplete_sessions(6 + 2 + 3, 2), failed_catch_trials(1)])
    assert [(o.reached, o.removed) for o in result.outcomes] == [(20, 2), (18, 4)]
    for flow in result.flow:
        assert flow.answered == 10
        assert flow.removed == (1, 2)
        assert flow.answered - sum(flow.removed) == flow.analysed == 7
    assert result.sessions_analysed == 14
    assert {e.rule for e in result.exclusions} == {"incomplete", "failed catch trials"}
    unfinished = next(e for e in result.exclusions if e.rule == "incomplete")
    assert unfinished.reason == "10 of 22 answers given"


def test_a_session_known_to_be_finished_stays_though_a_video_would_not_play(answer):
    rows = [answer(study_session=session, position=1) for session in ("s1", "s2")]
    result = exclude(responses_frame(rows), [incomplete_sessions(2, 1, completed={"s2"})])
    assert [e.study_session for e in result.exclusions] == ["s1"]
    assert result.sessions_analysed == 1


def test_practice_and_catch_are_never_analysed_and_repeat_is(simulated_study):
    study = simulated_study(participants=6, segments=6, practice=2)
    result = exclude(study.responses(), [incomplete_sessions(11, 2), failed_catch_trials(1)])
    assert set(result.analysed["kind"]) == {"main", "repeat"}
    assert "broken" not in set(result.analysed["other"])
    per_session = result.analysed.groupby("study_session").size()
    assert set(per_session) == {6 * 2}


def test_the_excluded_are_in_everyone_and_nowhere_else(simulated_study):
    result = exclude(simulated_study(participants=6).responses(), [failed_catch_trials(0)])
    gone = {e.study_session for e in result.exclusions}
    assert gone
    assert not gone & set(result.analysed["study_session"])
    assert gone <= set(result.everyone["study_session"])


def test_no_answers_give_an_empty_result():
    result = exclude(responses_frame([]), [incomplete_sessions(11, 2), failed_catch_trials(1)])
    assert result.flow == ()
    assert result.sessions_answered == 0
    assert [(o.reached, o.removed) for o in result.outcomes] == [(0, 0), (0, 0)]


@pytest.mark.parametrize(
    ("values", "allowed", "reason"),
    [
        ((1, 1), 0, None),
        ((1, 2), 0, "1 attention check failed"),
        ((1, 2), 1, None),
    ],
)
def test_an_attention_check_is_failed_by_any_other_answer_than_the_one_asked_for(
    answer, values, allowed, reason
):
    rows = [
        answer(kind="attention", position=2, question=question, value=value, instructed="1")
        for question, value in zip(("synchronisation", "emotion"), values, strict=True)
    ]
    others = [answer(study_session=name, position=1) for name in ("s1", "s2")]

    result = exclude(responses_frame([*rows, *others]), [failed_attention_checks(allowed)])

    assert [e.reason for e in result.exclusions] == ([reason] if reason else [])
    assert set(result.everyone["kind"]) == {"main"}
