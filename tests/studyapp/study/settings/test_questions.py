from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from studyapp.study.settings.questions import Form, FormQuestion


def asked(**keys: Any) -> FormQuestion:
    return FormQuestion.model_validate({"name": "q", "text": "Which?", **keys})


YES_NO = asked(choices=["yes", "no"])
AGE = asked(kind="number", low=18, high=99)
SCALE = asked(kind="scale", low=1, high=5, choices=["never", "always"])


@pytest.mark.parametrize(
    ("question", "accepted", "refused"),
    [
        (YES_NO, ["yes", "no"], ["maybe", "Yes", ""]),
        (AGE, ["18", "99"], ["17", "100", "20.5", "old", "", "１８", "9" * 30]),
        (SCALE, ["1", "5"], ["0", "6", "never"]),
        (asked(kind="text"), ["anything", "<b>"], ["", "   ", "x" * 2001]),
        (asked(kind="text", required=False), ["", "words"], ["x" * 2001]),
    ],
)
def test_only_what_is_offered_can_be_answered(
    question: FormQuestion, accepted: list[str], refused: list[str]
) -> None:
    assert [question.problem(answer) for answer in accepted] == [None] * len(accepted)
    assert all(question.problem(answer) is not None for answer in refused)


@pytest.mark.parametrize(
    "question", [YES_NO, AGE, SCALE, asked(kind="text"), asked(choices=["a", "b"], eligible=["b"])]
)
def test_an_example_can_be_answered_and_lets_a_person_in(question: FormQuestion) -> None:
    assert question.problem(question.example) is None
    assert not question.eligible or question.example in question.eligible


def test_a_scale_names_its_ends() -> None:
    assert [SCALE.label(step) for step in SCALE.offered] == [
        "1 – never", "2", "3", "4", "5 – always",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"kind": "choice"}, "needs choices"),
        ({"kind": "text", "choices": ["a"]}, "cannot have choices"),
        ({"kind": "scale", "choices": ["a"]}, "or two"),
        ({"kind": "number", "low": 5, "high": 5}, "must be below"),
        ({"choices": ["yes", "no"], "eligible": ["perhaps"]}, "only name choices"),
    ],
)
def test_a_question_that_cannot_be_asked_is_refused(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        asked(**keys)


YES = {"name": "q", "text": "?", "choices": ["yes", "no"]}


@pytest.mark.parametrize(
    ("form", "said"),
    [
        ({"eligibility": [YES], "closing": [YES]}, "the same name"),
        (
            {"closing": [YES | {"eligible": ["yes"]}]},
            "under eligibility, consent and comprehension",
        ),
        # A question about the instructions can be answered rightly and wrongly.
        ({"comprehension": [YES]}, "comprehension question 'q'"),
        ({"comprehension": [YES | {"eligible": ["yes", "no"]}]}, "comprehension question 'q'"),
    ],
)
def test_a_form_that_cannot_be_filled_in_is_refused(form: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Form.model_validate(form)
