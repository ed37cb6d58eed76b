from __future__ import annotations

from typing import Any

import pytest

from studyapp.preflight.recruiting_checks import code_findings, pay_findings, recruiting_findings
from studyapp.study.settings.recruitment import Recruitment
from tests.studyapp.made_study import make_study

CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}


def found(
    minutes: int | None = 10,
    attention: int = 0,
    needed: int | None = None,
    payment: str = "",
    **recruitment: Any,
) -> dict[str, str]:
    """Return what is said under the name of each finding."""
    study = make_study(
        page={"consent": "You agree.", "minutes": minutes, "payment": payment},
        attention={"trials": attention},
        recruitment=recruitment,
    )
    return {
        each.name: each.what for each in (*recruiting_findings(study), *pay_findings(study, needed))
    }


def on_prolific(reward: int, currency: str = "", **pay: str) -> dict[str, Any]:
    return {
        "channel": "prolific",
        "prolific": CODES | {"reward": reward},
        "pay": {"currency": currency, **pay},
    }


def test_a_plain_link_needs_nothing() -> None:
    assert list(found(minutes=None)) == ["pay-not-stated"]


def test_what_prolific_would_miss_is_an_error() -> None:
    missing = found(minutes=None, channel="prolific")

    assert "completed, screened_out and failed_attention" in missing["codes-missing"]
    assert "recruitment.prolific.reward and page.minutes" in missing["pay-unknown"]
    study = make_study(recruitment={"channel": "prolific"})
    severities = {each.severity for each in recruiting_findings(study)}
    assert severities == {"error"}


def test_pay_by_the_hour_is_said() -> None:
    assert "9.00 GBP for an hour" in found(**on_prolific(150, "GBP"))["hourly-pay"]
    mturk = found(channel="mturk", mturk={"reward": "2.50"})
    assert "15.00 USD for an hour" in mturk["hourly-pay"]
    link = found(pay={"amount": "3.00", "currency": "EUR"}, needed=20)
    assert "18.00 EUR for an hour at the 10 minutes that they are told" in link["hourly-pay"]
    assert "9.00 EUR for an hour at the 20 minutes that they are expected" in link["hourly-pay"]


@pytest.mark.parametrize(
    ("reward", "currency", "name"),
    [
        (99, "GBP", "pay-below-prolific-minimum"),
        (100, "GBP", "pay-below-prolific-advice"),
        (133, "USD", "pay-below-prolific-minimum"),
        (134, "USD", "pay-below-prolific-advice"),
        (150, "", "currency-unknown"),
    ],
)
def test_pay_is_held_against_what_prolific_publishes(reward: int, currency: str, name: str) -> None:
    assert name in found(**on_prolific(reward, currency))


def test_enough_pay_is_only_told() -> None:
    assert list(found(**on_prolific(150, "GBP"))) == ["hourly-pay"]
    assert list(found(**on_prolific(200, "USD"))) == ["hourly-pay"]


def test_pay_is_judged_by_the_longer_of_what_is_told_and_needed() -> None:
    assert "pay-below-prolific-minimum" in found(needed=16, **on_prolific(150, "GBP"))


def test_pay_below_the_studys_own_minimum_is_warned_of() -> None:
    pay = {"amount": "2.00", "currency": "EUR", "hourly_minimum": "12.82"}

    below = found(pay=pay)["pay-below-own-minimum"]

    assert below == "an hour pays 12.00 EUR, less than your minimum of 12.82 EUR"
    assert "pay-below-own-minimum" not in found(pay=pay | {"amount": "2.14"})


@pytest.mark.parametrize(
    ("payment", "differs"),
    [("2.50 EUR", False), ("2,50 Euro", False), ("3 EUR", True), ("a voucher", False)],
)
def test_the_text_and_the_number_say_the_same(payment: str, differs: bool) -> None:
    said = found(payment=payment, pay={"amount": "2.50", "currency": "EUR"})

    assert ("payment-text-differs" in said) == differs


def test_whom_the_payment_rule_does_not_pay_is_said() -> None:
    one, two = (found(attention=n, channel="invitations") for n in (1, 2))

    assert "everybody who finishes is paid" in one["everybody-paid"]
    assert "who fails 2 of 2 attention checks need not be paid" in two["unpaid-rule"]


@pytest.mark.parametrize(("places", "said"), [(60, "find the study full"), (40, "leave places")])
def test_a_recruiter_is_told_as_many_places_as_there_are(places: int, said: str) -> None:
    prolific = CODES | {"reward": 150, "places": places}

    assert said in found(channel="prolific", prolific=prolific)["places-differ"]
    prolific["places"] = 50
    assert "places-differ" not in found(channel="prolific", prolific=prolific)


def test_codes_that_do_not_do_their_work_have_names_of_their_own() -> None:
    alike = Recruitment.model_validate(
        {"prolific": {"completed": "KX7QM2PWTR", "screened_out": "kx7qm2pwtr"}}
    )
    guessable = Recruitment.model_validate({"prolific": {"completed": "ABCDEFGH"}})

    assert [each.name for each in code_findings(alike)] == ["codes-alike"]
    (said,) = code_findings(guessable)
    assert (said.name, said.where) == ("code-guessable", "recruitment.prolific.completed")
