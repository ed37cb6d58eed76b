"""What recruiters need, whom the payment rule does not pay, and what an hour pays."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from decimal import Decimal
from pathlib import Path
from types import MappingProxyType
from typing import Final, NamedTuple

from motion.errors import InputError
from motion.listing import listed
from studyapp.preflight.finding import Finding, finding
from studyapp.recruitment.prolific_draft import CODE_TYPES, places_of
from studyapp.recruitment.record import FILE, read_made_there
from studyapp.study.settings.pay import hourly, money
from studyapp.study.settings.recruitment import FEWEST_FAILED_CHECKS, Recruitment
from studyapp.study.settings.study import Study


def code_findings(recruitment: Recruitment) -> Iterator[Finding]:
    """Say which of the study's codes do not do what codes are for."""
    for problem in recruitment.guessable_codes():
        key, _, why = problem.partition(": ")
        yield finding("code-guessable", why.partition(";")[0], where=key)
    for problem in recruitment.codes_alike():
        key, _, why = problem.partition(": ")
        yield finding("codes-alike", why, where=key)


def recruiting_findings(study: Study) -> Iterator[Finding]:
    """Say what is missing for the study's channel, and whom it does not pay."""
    recruitment = study.recruitment
    if recruitment.missing_codes:
        yield finding("codes-missing", missing=listed(recruitment.missing_codes))
    yield from _place_findings(study)
    limit, checks = recruitment.unpaid_failed_checks, study.attention.trials
    if recruitment.names_participants and limit and checks:
        if checks < limit:
            yield finding(
                "everybody-paid",
                checks=checks,
                limit=limit,
                remedy=f"Set attention.trials to {max(limit, FEWEST_FAILED_CHECKS)} or more, if "
                "the rule is to matter",
            )
        else:
            yield finding("unpaid-rule", checks=checks, limit=limit)


def made_findings(study: Study, root: Path) -> Iterator[Finding]:
    """Say which codes Prolific does not know, where the study in `root` was made there."""
    try:
        there = read_made_there(root).prolific_codes
    except InputError as damaged:
        yield finding("made-there-unreadable", damaged.what, where=FILE)
        return
    codes = study.recruitment.prolific.model_dump()
    unknown = [key for key, types in CODE_TYPES.items() if there.get(codes[key]) not in types]
    if there and unknown and study.recruitment.channel == "prolific":
        yield finding("codes-differ", unknown=listed(unknown))


def _place_findings(study: Study) -> Iterator[Finding]:
    recruitment, places = study.recruitment, places_of(study)
    told = {
        "prolific": ("recruitment.prolific.places", recruitment.prolific.places),
        "mturk": ("recruitment.mturk.assignments", recruitment.mturk.assignments),
    }
    key, recruited = told.get(recruitment.channel, ("", None))
    if recruited is not None and recruited != places:
        lost = "and find the study full" if recruited > places else "and leave places empty"
        yield finding("places-differ", where=key, recruited=recruited, places=places, lost=lost)


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
            yield finding("pay-unknown", where=missing[0], missing=listed(missing))
            return
    if amount is None:
        yield finding("pay-not-stated")
        return
    yield from _payment_text_findings(study, amount)
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
    yield finding("hourly-pay", pay=said)
    yield from _floor_findings(study, min(hourly(amount, count) for count in known.values()))


def _floor_findings(study: Study, paid: float) -> Iterator[Finding]:
    """Say which floors `paid`, the lower of what an hour pays, lies below."""
    recruitment = study.recruitment
    currency, least = recruitment.currency, recruitment.pay.least
    if least is not None and currency == recruitment.pay.currency and paid < least:
        yield finding(
            "pay-below-own-minimum", paid=money(paid, currency), least=money(least, currency)
        )
    if recruitment.channel != "prolific":
        return
    if not currency:
        yield finding("currency-unknown")
    elif (floors := PROLIFIC.get(currency)) is not None:
        for name, floor in (
            ("pay-below-prolific-minimum", floors.least),
            ("pay-below-prolific-advice", floors.advised),
        ):
            if paid < floor:
                yield finding(name, paid=money(paid, currency), floor=money(floor, currency))
                return


def _payment_text_findings(study: Study, amount: Decimal) -> Iterator[Finding]:
    """Say where what participants read holds amounts, and none is what they get."""
    told = [Decimal(found.replace(",", ".")) for found in _NUMBER.findall(study.page.payment)]
    if told and amount not in told:
        yield finding(
            "payment-text-differs",
            told=study.page.payment,
            paid=money(amount, study.recruitment.currency),
        )
