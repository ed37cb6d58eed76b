"""Each rule removes the right participants with a reason; those who cannot be judged are kept and
counted."""

import math
from typing import Any

import pytest

from analysis.answers.exclusion_rules import (
    ExclusionRule,
    ParticipantFacts,
    SameAnswer,
    answered_too_fast,
    apply_rules,
    failed_attention_checks,
    failed_catch_trials,
    incomplete,
    marked,
    straight_lined,
    watched_less,
)


def someone(name: str = "a", **facts: Any) -> ParticipantFacts:
    return ParticipantFacts(participant=name, **facts)


def answers_alike(*questions: tuple[str, int, float]) -> tuple[SameAnswer, ...]:
    return tuple(
        SameAnswer(question=q, answers=count, share=share) for q, count, share in questions
    )


CATCH, ATTENTION = failed_catch_trials, failed_attention_checks
ALIKE = straight_lined(0.9, 10)
FAST = answered_too_fast(3, 0.5)


@pytest.mark.parametrize(
    ("rule", "facts", "why"),
    [
        (CATCH(0), {"failed_catch": 1}, "1 catch trial failed"),
        (CATCH(1), {"failed_catch": 1}, ""),
        (CATCH(1), {"failed_catch": 2}, "2 catch trials failed"),
        (CATCH(1), {}, None),
        (ATTENTION(1), {"failed_attention": 3}, "3 attention checks failed"),
        (ATTENTION(1), {}, None),
        (incomplete(), {"settled": 30, "trials": 30}, ""),
        (incomplete(), {"settled": 12, "trials": 30}, "12 of 30 trials answered"),
        (incomplete(), {"settled": 0, "trials": 0}, "not begun"),
        (incomplete(), {}, None),
        (watched_less(0.9), {"watched": 0.9}, ""),
        (watched_less(0.9), {"watched": 0.8999}, "89.99% of the videos watched"),
        (watched_less(0.9), {}, None),
        (FAST, {"seconds": [1, 2, 3, 4]}, "2 of 4 answers given in less than 3 s"),
        (FAST, {"seconds": [1, 3, 3, 4]}, ""),
        (FAST, {"seconds": []}, None),
        (
            ALIKE,
            {"same_answers": answers_alike(("rhythm", 20, 0.95), ("emotion", 20, 0.4))},
            "the same answer 19 of 20 times to rhythm",
        ),
        (ALIKE, {"same_answers": answers_alike(("rhythm", 20, 0.85))}, ""),
        (ALIKE, {"same_answers": answers_alike(("rhythm", 9, 1.0), ("emotion", 20, 0.4))}, ""),
        (ALIKE, {"same_answers": answers_alike(("rhythm", 9, 1.0))}, None),
        (ALIKE, {}, None),
        (marked(), {"marked": "withdrew"}, "withdrew"),
    ],
)
def test_a_rule_removes_the_right_participants_with_a_reason(
    rule: ExclusionRule, facts: dict[str, Any], why: str | None
) -> None:
    assert rule.judge(someone(**facts)) == why


def test_a_participant_counts_under_the_first_rule_that_removes_them() -> None:
    participants = [
        someone("both", failed_catch=3, watched=0.2),
        someone("watching", failed_catch=0, watched=0.2),
        someone("fine", failed_catch=0, watched=1.0),
    ]
    result = apply_rules(participants, [failed_catch_trials(1), watched_less(0.9)])
    assert [(outcome.rule, outcome.reached, outcome.removed) for outcome in result.rules] == [
        ("catch", 3, 1),
        ("coverage", 2, 1),
    ]
    assert result.removed_by == {"both": 0, "watching": 1}
    assert not any(outcome.exploratory for outcome in result.rules)
    afterwards = failed_catch_trials(1).as_exploratory()
    other_way = apply_rules(participants, [watched_less(0.9), afterwards])
    assert [outcome.exploratory for outcome in other_way.rules] == [False, True]
    assert other_way.removed_by == {"both": 0, "watching": 0}
    assert result.exclusions.keys() == other_way.exclusions.keys()


@pytest.mark.parametrize(
    ("watched", "removed", "remark"),
    [
        ([math.nan, math.nan], [], "cannot be applied: how much of the videos was watched"),
        ([0.1, math.nan, 1.0], ["p0"], "cannot be applied to 1 of 3 participants, who stay"),
    ],
)
def test_participants_without_the_facts_of_a_rule_are_kept_and_counted(
    watched: list[float], removed: list[str], remark: str
) -> None:
    participants = [someone(f"p{place}", watched=share) for place, share in enumerate(watched)]
    result = apply_rules(participants, [watched_less(0.9)])
    assert list(result.exclusions) == removed
    assert result.rules[0].remark.startswith(remark)
