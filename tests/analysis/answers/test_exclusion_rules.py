"""Each rule removes whom it says, and says why; who cannot be judged stays and is counted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from analysis.answers.exclusion_rules import (
    ExclusionRule,
    Removed,
    answered_too_fast,
    apply_rules,
    failed_attention_checks,
    failed_catch_trials,
    incomplete,
    marked,
    straight_lined,
    watched_less,
)
from analysis.answers.participant_facts import ParticipantFacts, SameAnswer


def someone(name: str = "a", **facts: Any) -> ParticipantFacts:
    return ParticipantFacts(participant=name, **facts)


def reason(rule: ExclusionRule, **facts: Any) -> str | None:
    return rule.judge(someone(**facts))


def applied(participants: list[ParticipantFacts], *rules: ExclusionRule) -> Removed:
    return apply_rules(participants, rules)


@pytest.mark.parametrize(
    ("failed", "allowed", "why"),
    [
        (0, 0, ""),
        (1, 0, "1 catch trial failed"),
        (1, 1, ""),
        (2, 1, "2 catch trials failed"),
        (None, 1, None),
    ],
)
def test_more_failed_catch_trials_than_allowed_remove(
    failed: int | None, allowed: int, why: str | None
) -> None:
    assert reason(failed_catch_trials(allowed), failed_catch=failed) == why


@pytest.mark.parametrize(
    ("failed", "why"), [(1, ""), (3, "3 attention checks failed"), (None, None)]
)
def test_more_failed_attention_checks_than_allowed_remove(
    failed: int | None, why: str | None
) -> None:
    assert reason(failed_attention_checks(1), failed_attention=failed) == why


@pytest.mark.parametrize(
    ("settled", "trials", "why"),
    [(30, 30, ""), (12, 30, "12 of 30 trials answered"), (0, 0, "not begun"), (None, None, None)],
)
def test_who_did_not_reach_the_end_is_removed(
    settled: int | None, trials: int | None, why: str | None
) -> None:
    assert reason(incomplete(), settled=settled, trials=trials) == why


@pytest.mark.parametrize(
    ("watched", "why"), [(0.9, ""), (0.8999, "89.99% of the videos watched"), (math.nan, None)]
)
def test_who_watched_less_than_the_share_is_removed(watched: float, why: str | None) -> None:
    assert reason(watched_less(0.9), watched=watched) == why


@pytest.mark.parametrize(
    ("seconds", "share", "why"),
    [
        ([1.0, 2.0, 3.0, 4.0], 0.5, "2 of 4 answers given in less than 3 s"),
        ([1.0, 3.0, 3.0, 4.0], 0.5, ""),
        ([1.0, 1.0, 1.0, *[9.0] * 7], 0.3, "3 of 10 answers given in less than 3 s"),
        ([], 0.5, None),
    ],
)
def test_who_answers_too_often_too_fast_is_removed(
    seconds: list[float], share: float, why: str | None
) -> None:
    assert reason(answered_too_fast(3, share), seconds=np.array(seconds)) == why


@pytest.mark.parametrize(
    ("lists", "why"),
    [
        ([("rhythm", 20, 0.95), ("emotion", 20, 0.4)], "the same answer 19 of 20 times to rhythm"),
        ([("rhythm", 20, 0.85)], ""),
        ([("rhythm", 9, 1.0), ("emotion", 20, 0.4)], ""),
        ([("rhythm", 9, 1.0)], None),
        (None, None),
    ],
)
def test_who_gives_one_answer_to_a_question_is_removed(
    lists: list[tuple[str, int, float]] | None, why: str | None
) -> None:
    same = (
        None
        if lists is None
        else tuple(
            SameAnswer(question=question, answers=answers, share=share)
            for question, answers, share in lists
        )
    )
    assert reason(straight_lined(0.9, 10), same_answers=same) == why


def test_a_mark_in_the_table_removes_for_the_reason_written_there() -> None:
    assert reason(marked(), marked="withdrew") == "withdrew"
    assert reason(marked()) == ""


def test_a_participant_counts_under_the_first_rule_that_removes_them() -> None:
    participants = [
        someone("both", failed_catch=3, watched=0.2),
        someone("watching", failed_catch=0, watched=0.2),
        someone("fine", failed_catch=0, watched=1.0),
    ]
    result = applied(participants, failed_catch_trials(1), watched_less(0.9))
    assert [(outcome.rule, outcome.reached, outcome.removed) for outcome in result.outcomes] == [
        ("catch", 3, 1),
        ("coverage", 2, 1),
    ]
    assert result.removed_by == {"both": 0, "watching": 1}
    other_way = applied(participants, watched_less(0.9), failed_catch_trials(1))
    assert other_way.removed_by == {"both": 0, "watching": 0}
    assert result.reasons.keys() == other_way.reasons.keys()


def test_a_rule_without_facts_removes_nobody_and_says_so() -> None:
    result = applied([someone("a"), someone("b")], watched_less(0.9))
    assert result.reasons == {}
    assert result.outcomes[0].remark == (
        "cannot be applied: how much of the videos was watched is not known"
    )


def test_who_cannot_be_judged_stays_and_is_counted() -> None:
    participants = [someone("a", watched=0.1), someone("b"), someone("c", watched=1.0)]
    result = applied(participants, watched_less(0.9))
    assert list(result.reasons) == ["a"]
    assert result.outcomes[0].remark.startswith(
        "cannot be applied to 1 of 3 participants, who stay"
    )


def test_a_rule_of_afterwards_is_marked_in_its_outcome() -> None:
    result = applied([someone(failed_catch=1)], failed_catch_trials(0).as_exploratory())
    assert result.outcomes[0].exploratory
    assert not applied([someone()], marked()).outcomes[0].exploratory


def test_descriptions_read_well_after_a_count() -> None:
    rules = (
        failed_catch_trials(0),
        failed_catch_trials(2),
        failed_attention_checks(0),
        watched_less(0.925),
        answered_too_fast(2.5, 0.5),
        straight_lined(0.9, 12),
    )
    assert [rule.description for rule in rules] == [
        "failed a catch trial",
        "failed more than 2 catch trials",
        "failed an attention check",
        "watched less than 92.5% of the videos",
        "gave at least 50% of the answers in less than 2.5 s",
        "gave the same answer to at least 90% of one question asked 12 times or more",
    ]
