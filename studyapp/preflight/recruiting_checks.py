"""What recruiters need, what participants are told beforehand, and whom and what an hour pays."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from decimal import Decimal
from pathlib import Path
from types import MappingProxyType
from typing import Final, NamedTuple, get_args

from motion.errors import InputError, listed
from studyapp.preflight.finding import Finding, finding
from studyapp.recruitment.prolific import CODE_TYPES
from studyapp.recruitment.record import FILE, places_of, read_made_there
from studyapp.study.settings.presentation import Language, reaches_somebody
from studyapp.study.settings.recruitment import MIN_FAILED_CHECKS, format_amount, hourly_rate
from studyapp.study.settings.study import Study
from studyapp.study.template_language import render_template, untranslated_keys


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
                remedy=f"Set attention.trials to {max(limit, MIN_FAILED_CHECKS)} or more, if "
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
        f"{format_amount(hourly_rate(amount, count), currency)} for an hour at the {count} minutes "
        f"{'that they are told' if words == 'told' else 'that they are expected to need'}"
        for words, count in known.items()
    )
    yield finding("hourly-pay", pay=said)
    yield from _floor_findings(study, min(hourly_rate(amount, count) for count in known.values()))


def _floor_findings(study: Study, paid: float) -> Iterator[Finding]:
    """Say which floors `paid`, the lower of what an hour pays, lies below."""
    recruitment = study.recruitment
    currency, least = recruitment.currency, recruitment.pay.minimum
    if least is not None and currency == recruitment.pay.currency and paid < least:
        yield finding(
            "pay-below-own-minimum",
            paid=format_amount(paid, currency),
            least=format_amount(least, currency),
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
                yield finding(
                    name, paid=format_amount(paid, currency), floor=format_amount(floor, currency)
                )
                return


def _payment_text_findings(study: Study, amount: Decimal) -> Iterator[Finding]:
    """Say where what participants read holds amounts, and none is what they get."""
    told = [Decimal(found.replace(",", ".")) for found in _NUMBER.findall(study.page.payment)]
    if told and amount not in told:
        yield finding(
            "payment-text-differs",
            told=study.page.payment,
            paid=format_amount(amount, study.recruitment.currency),
        )


def page_findings(study: Study) -> Iterator[Finding]:
    """Say what participants are not told, and what still says what a template says."""
    page = study.page
    for given, name in (
        (page.organisation, "organisation-missing"),
        (page.contact, "contact-missing"),
        (page.payment, "payment-missing"),
        (page.minutes, "minutes-missing"),
        (page.ethics, "ethics-missing"),
    ):
        if not given or not str(given).strip():
            yield finding(name)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield finding("contact-unreachable", contact=page.contact)
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    consents, titles = _template_texts(study)
    if not study.page.consent.strip():
        yield finding("consent-blank")
    elif _squeezed(study.page.consent) in consents:
        yield finding("consent-from-template")
    if _squeezed(study.title) in titles:
        yield finding("title-from-template", title=study.title)
    english = untranslated_keys(study)
    if english:
        yield finding("texts-untranslated", language=study.page.language, texts=listed(english))


def _template_texts(study: Study) -> tuple[set[str], set[str]]:
    """Return the consent texts and the titles that templates of the protocol have."""
    file = f"{study.protocol}.toml"
    consents, titles = set(), set()
    for language in get_args(Language):
        source = tomllib.loads(render_template(file, language))
        consents.add(_squeezed(source["page"]["consent"]))
        titles.add(_squeezed(source["title"]))
    return consents, titles


def _squeezed(text: str) -> str:
    """Return a text in which white space says nothing."""
    return " ".join(text.split())
