from __future__ import annotations

from decimal import Decimal
from typing import Any

import pytest
from pydantic import ValidationError

from studyapp.study.settings.pay import hourly, money
from studyapp.study.settings.recruitment import Recruitment
from tests.studyapp.made_study import make_study


def recruited(**keys: Any) -> Recruitment:
    return Recruitment.model_validate(keys)


def test_each_channel_has_its_own_key_for_what_is_paid() -> None:
    pay = {"amount": "3.00", "currency": "EUR"}
    assert recruited(pay=pay).amount == Decimal("3.00")
    prolific = recruited(channel="prolific", pay=pay, prolific={"reward": 250})
    assert (prolific.amount, prolific.currency) == (Decimal("2.50"), "EUR")
    mturk = recruited(channel="mturk", pay=pay, mturk={"reward": "1.75"})
    assert (mturk.amount, mturk.currency) == (Decimal("1.75"), "USD")


def test_what_is_not_stated_is_none() -> None:
    assert recruited().amount is None
    assert recruited(channel="prolific").amount is None


@pytest.mark.parametrize(
    "pay",
    [
        {"amount": "2,50", "currency": "EUR"},
        {"amount": "2.5", "currency": "EUR"},
        {"currency": "euro"},
        {"amount": "2.50"},
        {"hourly_minimum": "12.00"},
    ],
)
def test_pay_that_cannot_be_reckoned_with_is_refused(pay: dict[str, str]) -> None:
    with pytest.raises(ValidationError, match=r"recruitment\.pay|pattern"):
        make_study(recruitment={"pay": pay})


def test_pay_for_an_hour_and_in_words() -> None:
    assert hourly(Decimal("2.50"), 15) == 10.0
    assert money(10, "EUR") == "10.00 EUR"
    assert money(Decimal("2.5"), "") == "2.50"
