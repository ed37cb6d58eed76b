from typing import Any

import pytest
from pydantic import ValidationError

from studyapp.study.settings.presentation import Page
from studyapp.study.settings.questions import Form, FormQuestion
from studyapp.study.settings.reading import PROTOCOLS, parse_text
from studyapp.study.settings.recruitment import CODE_LENGTH, draw_code, is_guessable
from studyapp.study.settings.rehearsal import Rehearsal
from studyapp.study.study_file import render_template
from tests.support.studies.made_study import CODES, make_study


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
        (asked(choices=["a", "b"], eligible=["b"]), ["a", "b"], ["c"]),
        (asked(kind="text"), ["anything", "<b>"], ["", "   ", "x" * 2001]),
        (asked(kind="text", required=False), ["", "words"], ["x" * 2001]),
    ],
)
def test_only_offered_answers_are_accepted_and_the_example_admits_a_person(
    question: FormQuestion, accepted: list[str], refused: list[str]
) -> None:
    assert [question.problem(answer) for answer in accepted] == [None] * len(accepted)
    assert all(question.problem(answer) is not None for answer in refused)
    assert question.problem(question.example) is None
    assert not question.eligible or question.example in question.eligible


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"kind": "choice"}, "needs choices"),
        ({"kind": "text", "choices": ["a"]}, "cannot have choices"),
        ({"kind": "scale", "choices": ["a"]}, "or two"),
        ({"kind": "number", "low": 5, "high": 5}, "must be below"),
        ({"choices": ["yes", "no"], "eligible": ["perhaps"]}, "only name choices"),
        ({"choices": ["yes", "yes "]}, "must be different"),
        ({"choices": ["yes", " "]}, "none may be empty"),
        ({"kind": "scale"}, "from 0 to 120 has more than 40 steps"),
    ],
)
def test_an_invalid_question_is_refused(keys: dict[str, Any], said: str) -> None:
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
def test_an_unanswerable_form_is_refused(form: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        Form.model_validate(form)


@pytest.mark.parametrize(
    ("every", "presentations", "breaks"),
    [(10, 24, [10]), (10, 25, [10, 20]), (1, 4, [1, 2]), (0, 100, [])],
)
def test_breaks_come_at_intervals_but_not_shortly_before_the_end(
    every: int, presentations: int, breaks: list[int]
) -> None:
    page = Page(consent="You agree.", break_every=every)

    due = [done for done in range(presentations + 1) if page.break_after(done, presentations)]

    assert due == breaks


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"unpaid_failed_checks": 1}, "not enough to refuse pay"),
        (
            {"prolific": CODES | {"completed": "STUDY-2026"}},
            "prolific.completed: the code could be guessed",
        ),
        ({"prolific": CODES | {"screened_out": "kx7qm2pwtr"}}, "two outcomes have the same code"),
        ({"pay": {"amount": "2.50"}}, "recruitment.pay: an amount needs a currency"),
        ({"channel": "mturk", "pay": {"currency": "EUR"}}, "pays in USD, not in EUR"),
    ],
)
def test_invalid_codes_and_pay_are_refused(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError) as refused:
        make_study(recruitment=keys)
    assert said in str(refused.value)


def test_one_failed_check_may_refuse_pay_only_in_short_studies() -> None:
    page = {"consent": "You agree.", "minutes": 4}
    short = make_study(page=page, recruitment={"unpaid_failed_checks": 1})
    assert short.recruitment.outcome(1) == "failed_attention"


GUESSABLE = "KX7QM2P AAAAAAAAAA ABABABABAB COMPLETED7X prolific-42 K1234567X9 KXQM7KXQM7"


def test_a_guessable_code_is_reported_and_recruiters_codes_are_not() -> None:
    for code in GUESSABLE.split():
        assert is_guessable(code), code
    for code in ("KX7QM2PWTR", "C1G9PC0D", "8E8AC860"):
        assert not is_guessable(code), code


def test_generated_codes_are_strong_and_distinct() -> None:
    drawn = {draw_code() for _ in range(500)}

    assert len(drawn) == 500
    assert {len(code) for code in drawn} == {CODE_LENGTH}
    assert not any(map(is_guessable, drawn))


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_every_template_states_the_defaults(protocol: str) -> None:
    text = render_template(protocol)
    assert parse_text(text, where="study.toml").rehearsal == Rehearsal()
    commented = text[text.index("# [rehearsal.strength]") : text.index("# What participants read")]
    stated = "\n".join(
        line.removeprefix("# ")
        for line in commented.splitlines()
        if "=" in line or line.startswith("# [")
    )
    study = parse_text(text.replace(commented, f"{stated}\n\n"), where="study.toml")
    assert study.rehearsal.strength
