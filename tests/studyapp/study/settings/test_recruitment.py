from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from studyapp.study.settings.recruitment import (
    CODE_LENGTH,
    code_weakness,
    draw_code,
)
from tests.support.studies.made_study import make_study

CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"unpaid_failed_checks": 1}, "not enough to refuse pay"),
        (
            {"prolific": CODES | {"completed": "DONE-ALL-99"}},
            "prolific.completed: the code contains the word",
        ),
        ({"prolific": CODES | {"screened_out": "kx7qm2pwtr"}}, "two outcomes have the same code"),
        ({"prolific": {"screened_out_reward": 10}}, "or neither"),
        (
            {"prolific": {"reward": 9, "screened_out_reward": 9, "screened_out_places": 5}},
            "less than reward",
        ),
        ({"pay": {"amount": "2,50", "currency": "EUR"}}, "pattern"),
        ({"pay": {"currency": "euro"}}, "pattern"),
        ({"pay": {"amount": "2.50"}}, "recruitment.pay: an amount needs a currency"),
        ({"pay": {"hourly_minimum": "12.00"}}, "recruitment.pay: an amount needs a currency"),
    ],
)
def test_codes_and_pay_that_cannot_be_right_are_refused(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError) as refused:
        make_study(recruitment=keys)
    assert said in str(refused.value)


def test_one_failed_check_costs_pay_in_short_studies() -> None:
    page = {"consent": "You agree.", "minutes": 4}
    short = make_study(page=page, recruitment={"unpaid_failed_checks": 1})
    assert short.recruitment.outcome(1) == "failed_attention"


GUESSABLE = "KX7QM2P AAAAAAAAAA ABABABABAB COMPLETED7X prolific-42 K1234567X9 XQWERTY79K 9876PWTRKX"


def test_a_code_that_could_be_guessed_is_told_and_those_of_recruiters_are_fine() -> None:
    for code in ("", *GUESSABLE.split(), "DONE-KX7QM2", "KXQM7KXQM7"):
        assert code_weakness(code) is not None, code
    for code in ("KX7QM2PWTR", "C1G9PC0D", "8E8AC860"):
        assert code_weakness(code) is None, code


def test_drawn_codes_are_fine_and_each_is_another() -> None:
    drawn = {draw_code() for _ in range(500)}

    assert len(drawn) == 500
    assert {len(code) for code in drawn} == {CODE_LENGTH}
    assert not any(code_weakness(code) for code in drawn)
