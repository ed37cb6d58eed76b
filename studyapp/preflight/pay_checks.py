"""What participants are paid for an hour, and whether that is enough."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from types import MappingProxyType
from typing import Final, NamedTuple

from motion.listing import listed
from studyapp.preflight.finding import Finding, finding
from studyapp.study.settings.pay import hourly, money
from studyapp.study.settings.study import Study


class Floors(NamedTuple):
    """What an hour must and should pay."""

    least: int
    advised: int


PROLIFIC: Final[Mapping[str, Floors]] = MappingProxyType(
    {"GBP": Floors(6, 9), "USD": Floors(8, 12)}
)
"""As Prolific's payment principles state them (researcher-help.prolific.com)."""

_NUMBER: Final = re.compile(r"\d+(?:[.,]\d{1,2})?")


def pay_findings(study: Study, needed: int | None) -> Iterator[Finding]:
    """Say what is paid for an hour, and where that is too little.

    Parameters
    ----------
    needed : int or None
        Minutes that participants are expected to need.
    """
    recruitment, told = study.recruitment, study.page.minutes
    amount = recruitment.amount
    if recruitment.channel in ("prolific", "mturk"):
        reward = f"recruitment.{recruitment.channel}.reward"
        missing = [*([] if amount else [reward]), *([] if told else ["page.minutes"])]
        if missing:
            yield finding(
                "pay-unknown", f"{listed(missing)} must be known to recruiters", where=missing[0]
            )
            return
    if amount is None:
        yield finding("pay-not-stated", where="recruitment.pay")
        return
    yield from _text_findings(study, amount)
    minutes = {
        "told": told,
        "needed": needed,
    }
    known = {words: count for words, count in minutes.items() if count is not None}
    if not known:
        return
    currency = recruitment.currency
    said = " and ".join(
        f"{money(hourly(amount, count), currency)} for an hour at the {count} minutes that "
        f"{'they are told' if words == 'told' else 'they are expected to need'}"
        for words, count in known.items()
    )
    yield finding("hourly-pay", f"participants are paid {said}", where="recruitment")
    yield from _floor_findings(study, min(hourly(amount, count) for count in known.values()))


def _floor_findings(study: Study, paid: float) -> Iterator[Finding]:
    """Say which floors `paid`, the lower of what an hour pays, lies below."""
    recruitment = study.recruitment
    currency, least = recruitment.currency, recruitment.pay.least
    if least is not None and currency == recruitment.pay.currency and paid < least:
        yield finding(
            "pay-below-own-minimum",
            f"an hour pays {money(paid, currency)}, less than your minimum of "
            f"{money(least, currency)}",
            where="recruitment.pay.hourly_minimum",
        )
    if recruitment.channel != "prolific":
        return
    if not currency:
        yield finding("currency-unknown", where="recruitment.pay.currency")
    elif (floors := PROLIFIC.get(currency)) is not None:
        if paid < floors.least:
            yield finding(
                "pay-below-prolific-minimum",
                f"an hour pays {money(paid, currency)}, and Prolific allows no less than "
                f"{money(floors.least, currency)}",
                where="recruitment.prolific.reward",
            )
        elif paid < floors.advised:
            yield finding(
                "pay-below-prolific-advice",
                f"an hour pays {money(paid, currency)}, and Prolific recommends "
                f"{money(floors.advised, currency)}",
                where="recruitment.prolific.reward",
            )


def _text_findings(study: Study, amount: Decimal) -> Iterator[Finding]:
    """Say where what participants read holds amounts, and none is what they get."""
    told = [Decimal(found.replace(",", ".")) for found in _NUMBER.findall(study.page.payment)]
    if told and amount not in told:
        yield finding(
            "payment-text-differs",
            f"page.payment says {study.page.payment!r}, and participants get "
            f"{money(amount, study.recruitment.currency)}",
            where="page.payment",
        )
