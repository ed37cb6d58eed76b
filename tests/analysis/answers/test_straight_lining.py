from __future__ import annotations

import pandas as pd
import pytest

from analysis.answers.straight_lining import straight_lining


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


def test_runs_are_counted_within_a_question():
    [found] = straight_lining(table(p={"a": [1, 1, 1, 2], "b": [1, 2, 2, 1]}))
    assert (found.longest_run, found.run_share) == (3, 0.75)
    assert (found.commonest, found.commonest_share) == (1, pytest.approx(5 / 8))
    assert found.answers == 8


def test_everybody_is_looked_at_alone():
    found = straight_lining(table(p={"a": [2, 2, 2, 2]}, q={"a": [2, 1, 2, 1]}))
    assert [(f.participant, f.longest_run) for f in found] == [("p", 4), ("q", 1)]
    assert [f.run_share for f in found] == [1, 0.25]
    assert [(f.commonest, f.commonest_share) for f in found] == [(2, 1), (1, 0.5)]


def test_no_answers_give_nothing():
    assert straight_lining(table()) == ()


def test_categories_and_order_of_appearance_are_kept():
    answers = table(z={"a": [0, 0]}, b={"a": [1, -1]}).astype({"participant": "category"})
    assert [f.participant for f in straight_lining(answers)] == ["z", "b"]
