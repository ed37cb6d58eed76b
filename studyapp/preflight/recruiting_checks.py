"""What recruiting sites need, what participants are told, and what they are paid."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final, get_args

from motion.errors import InputError, listed
from studyapp.preflight.finding import Finding, make_finding
from studyapp.recruitment.prolific import CODE_TYPES
from studyapp.recruitment.record import FILE, read_record
from studyapp.study.settings.presentation import Language, reaches_somebody
from studyapp.study.settings.recruitment import format_amount, hourly_rate
from studyapp.study.settings.study import Study
from studyapp.study.study_file import read_texts


def recruiting_findings(study: Study) -> Iterator[Finding]:
    """Yield what the study's channel lacks."""
    recruitment = study.recruitment
    if recruitment.missing_codes:
        yield make_finding("codes-missing", missing=listed(recruitment.missing_codes))


def prolific_code_findings(study: Study, root: Path) -> Iterator[Finding]:
    """Yield codes that Prolific does not know, if the study in `root` was created there."""
    try:
        known = read_record(root).prolific_codes
    except InputError as error:
        yield make_finding("made-there-unreadable", error.what, where=FILE)
        return
    codes = study.recruitment.prolific.model_dump()
    unknown = [key for key, type_ in CODE_TYPES.items() if known.get(codes[key]) != type_]
    if known and unknown and study.recruitment.channel == "prolific":
        yield make_finding("codes-differ", unknown=listed(unknown))


PROLIFIC: Final[Mapping[str, Mapping[str, int]]] = {
    "GBP": {"pay-below-prolific-minimum": 6, "pay-below-prolific-advice": 9},
    "USD": {"pay-below-prolific-minimum": 8, "pay-below-prolific-advice": 12},
}
"""The least that Prolific allows per hour and what it recommends, by currency, from its payment
principles (researcher-help.prolific.com)."""


def pay_findings(study: Study, needed: int | None) -> Iterator[Finding]:
    """Yield the hourly rate, and the minimums that it does not reach.

    Parameters
    ----------
    needed : int or None
        Minutes that participants are expected to need.
    """
    recruitment, stated = study.recruitment, study.page.minutes
    amount = recruitment.amount
    if recruitment.channel in ("prolific", "mturk"):
        reward = f"recruitment.{recruitment.channel}.reward"
        missing = [*([] if amount else [reward]), *([] if stated else ["page.minutes"])]
        if missing:
            yield make_finding("pay-unknown", where=missing[0], missing=listed(missing))
            return
    if amount is None:
        yield make_finding("pay-not-stated")
        return
    durations = {
        "they are told": stated,
        "they are expected to need": needed,
    }
    rates = {
        words: (minutes, hourly_rate(amount, minutes))
        for words, minutes in durations.items()
        if minutes is not None
    }
    if not rates:
        return
    currency = recruitment.currency
    pay = " and ".join(
        f"{format_amount(rate, currency)} per hour at the {minutes} minutes that {words}"
        for words, (minutes, rate) in rates.items()
    )
    yield make_finding("hourly-pay", pay=pay)
    yield from _minimum_findings(study, min(rate for _, rate in rates.values()))


def _minimum_findings(study: Study, paid: float) -> Iterator[Finding]:
    """Yield the minimums above the hourly rate `paid`."""
    recruitment = study.recruitment
    currency, minimum = recruitment.currency, recruitment.pay.minimum
    if minimum is not None and paid < minimum:
        yield make_finding(
            "pay-below-own-minimum",
            paid=format_amount(paid, currency),
            minimum=format_amount(minimum, currency),
        )
    if recruitment.channel != "prolific":
        return
    if currency not in PROLIFIC:
        yield make_finding("currency-unknown")
    for name, floor in PROLIFIC.get(currency, {}).items():
        if paid < floor:
            yield make_finding(
                name, paid=format_amount(paid, currency), floor=format_amount(floor, currency)
            )
            return


def page_findings(study: Study) -> Iterator[Finding]:
    """Yield what participants are not told, and texts that are still a template's."""
    page = study.page
    for value, name in (
        (page.organisation, "organisation-missing"),
        (page.contact, "contact-missing"),
        (page.payment, "payment-missing"),
        (page.minutes, "minutes-missing"),
        (page.ethics, "ethics-missing"),
    ):
        if not value or not str(value).strip():
            yield make_finding(name)
    if page.contact.strip() and not reaches_somebody(page.contact):
        yield make_finding("contact-unreachable", contact=page.contact)
    yield from _text_findings(study)


def _text_findings(study: Study) -> Iterator[Finding]:
    own = [read_texts(study.protocol, language) for language in get_args(Language)]
    consent, title = _normalise_space(study.page.consent), _normalise_space(study.title)
    if not consent:
        yield make_finding("consent-blank")
    elif consent in {_normalise_space(template["page"]["consent"]) for template in own}:
        yield make_finding("consent-from-template")
    if title in {_normalise_space(template["title"]) for template in own}:
        yield make_finding("title-from-template", title=study.title)


def _normalise_space(text: str) -> str:
    return " ".join(text.split())
