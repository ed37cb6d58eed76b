from __future__ import annotations

import pandas as pd

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
