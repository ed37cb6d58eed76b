from __future__ import annotations

import math

import numpy as np
import pandas as pd

from analysis.answers.quality import response_times, straight_lining

SECONDS = np.array([20.0, 30, 40, 20, 22, 24, 30, 30, np.nan, 2, 3, 30])
PEOPLE = list("aaabbbcccddd")


def test_medians_are_those_of_participants_not_of_answers() -> None:
    found = response_times(SECONDS, PEOPLE)
    assert (found.low_quartile, found.median, found.high_quartile) == (17.25, 26, 30)
    assert (found.n, found.missing) == (11, 1)


def test_half_the_typical_time_is_too_fast() -> None:
    found = response_times(SECONDS, PEOPLE)
    assert found.limit == 13
    assert found.too_fast == {"d": 3}


def test_no_times_give_a_reason() -> None:
    found = response_times(np.array([np.nan]), ["a"])
    assert (found.reason, found.missing, found.too_fast) == ("no response times", 1, {})
    assert math.isnan(found.median)


def table(**answers):
    """Return answers: participant to question to values, shuffled between participants."""
    rows = [
        (turn, participant, question, value)
        for participant, questions in answers.items()
        for question, values in questions.items()
        for turn, value in enumerate(values)
    ]
    rows.sort(key=lambda row: row[0])
    return pd.DataFrame(rows, columns=["turn", "participant", "question", "value"])


def test_everybody_is_looked_at_alone() -> None:
    found = straight_lining(
        table(p={"a": [1, 1, 1, 2], "b": [1, 2, 2, 1]}, q={"a": [2, 2], "b": [2]})
    )
    assert [(one.participant, one.answers, one.share) for one in found] == [
        ("p", 8, 5 / 8),
        ("q", 3, 1),
    ]


def test_no_answers_give_nothing():
    assert straight_lining(table()) == ()


def test_categories_and_order_of_appearance_are_kept():
    answers = table(z={"a": [0, 0]}, b={"a": [1, -1]}).astype({"participant": "category"})
    assert [f.participant for f in straight_lining(answers)] == ["z", "b"]
