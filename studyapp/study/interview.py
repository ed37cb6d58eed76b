"""The questions that a new study needs answered, and how the answers are read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from types import MappingProxyType
from typing import Final, Literal

from generators.registry import generator_names, needs_model
from motion.errors import InputError
from studyapp.study.condition_options import FILES, VIDEOS, source_notation
from studyapp.study.settings.presentation import Framing, reaches_somebody
from studyapp.study.settings.recruitment import MONEY, Pay
from studyapp.study.study_options import StudyOptions

MAX_MINUTES: Final = 240
"""Longest study that can be set up."""

MAX_PARTICIPANTS: Final = 10_000

RECRUITING_SITES: Final = ("prolific", "mturk")
"""Channels that must be told the pay and the duration."""

TEMPLATE_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "pairwise": "two motions for the same speech side by side: which one is preferred? As in "
        "AMUSE; for few conditions and small differences",
        "rating": "several motions for the same speech on one page, each rated on a scale. As in "
        "S2UE; for absolute judgements of many conditions",
        "ranking": "several motions for the same speech, ranked, beside the recording. As in "
        "DiffSHEG; for many conditions that differ clearly",
        "mismatch": "one motion with its own speech and with another: which fits? As in GENEA; "
        "tests whether motion follows speech at all",
        "three-systems": "AMUSE, DiffSHEG and Speech2UnifiedExpressions in pairs with rule-based "
        "motion, mismatched motion and the recording; for networks that you have",
    }
)

LANGUAGES: Final[Mapping[str, str]] = MappingProxyType(
    {"en": "English", "de": "German", "ja": "Japanese"}
)

CHANNEL_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "link": "anybody with the study's address; everyone who finishes gets a code",
        "invitations": "people you invite; each gets a personal link",
        "prolific": "people from Prolific; drafts, places and pay go through its API",
        "mturk": "workers on Mechanical Turk, if you are already a requester there",
    }
)

SOURCE_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        FILES: "motion files imported with 'motionjury import': recordings, a system's output",
        VIDEOS: "finished videos in videos/NAME/; nothing is rendered",
        "rule_based": "generated here from the speech: beat gestures by rule",
        "static": "generated here: stands still",
        "mismatched": "another condition's motion for other speech: plausible, but out of time",
    }
)


FRAMING_DESCRIPTIONS: Final[Mapping[Framing | Literal[""], str]] = MappingProxyType(
    {
        "": "as the questions need",
        "upper_body": "upper body, with room for the hands",
        "full_body": "full body, with the feet",
        "face": "face: head and neck",
        "hands": "hands and lower arms",
    }
)


@dataclass(frozen=True)
class InterviewQuestion:
    """One question, and what its answer is for."""

    label: str
    why: str


QUESTIONS: Final[Mapping[str, InterviewQuestion]] = MappingProxyType(
    {
        "template": InterviewQuestion(
            "Protocol", "What do participants do? Everything else follows from it."
        ),
        "language": InterviewQuestion(
            "Language",
            "In which language are the participants' pages, the questions and the consent form?",
        ),
        "conditions": InterviewQuestion(
            "Conditions",
            "Conditions are the systems you compare. Name your own, or start with stand-ins "
            "generated here, to try everything before you have motion.",
        ),
        "catch_videos": InterviewQuestion(
            "Will you bring videos of a broken motion",
            "Catch trials show a visibly broken motion beside a good one, to detect participants "
            "who do not watch. Finished videos cannot be broken here: put broken ones into "
            "videos/broken/. Without them, the study has attention checks instead.",
        ),
        "framing": InterviewQuestion(
            "Framing",
            "How much of the body do all videos show? 'As the questions need' is the face if every "
            "question is about it, otherwise the upper body; if only some are, 'motionjury check' "
            "says how large the face is. The camera's angle, the background and the size of the "
            "videos are under [video] in the study's settings.",
        ),
        "channel": InterviewQuestion(
            "Recruiting",
            "Where do participants come from? You can change this while the study runs.",
        ),
        "pay": InterviewQuestion(
            "Pay",
            "What does each participant get? An amount with a currency, such as 2.50 EUR: on "
            "Prolific the currency of your account, GBP or USD, on Mechanical Turk USD. "
            "Participants read it, and 'motionjury check' computes the hourly rate.",
        ),
        "minutes": InterviewQuestion(
            "Minutes",
            "How many minutes does it take? 'motionjury check' estimates it from your videos and "
            "questions, and warns where this number is wrong.",
        ),
        "title": InterviewQuestion(
            "Title",
            "What title do participants see? It should not reveal what you expect.",
        ),
        "organisation": InterviewQuestion(
            "Institution", "Who runs the study? Participants read it before they consent."
        ),
        "contact": InterviewQuestion(
            "Contact", "Whom can they ask? An e-mail address that somebody reads."
        ),
        "ethics": InterviewQuestion(
            "Ethics",
            "Who approved the study? The committee and its number; empty if it is still pending.",
        ),
    }
)
STAND_INS: Final = (
    "motion generated here: rule-based and mismatched; for ratings and rankings also static and "
    "flawed motion, for three-systems also the three networks"
)


def participants_question(template: str) -> InterviewQuestion:
    """Return the question about the number of participants."""
    scope = "for each comparison with the reference" if template == "pairwise" else "in all"
    return InterviewQuestion(
        "Participants",
        f"How many take part, {scope}? The default is the published study's number; 'motionjury "
        "plan' computes how many a difference needs.",
    )


def reference_question(template: str) -> InterviewQuestion:
    """Return the question about the reference."""
    if template == "pairwise":
        why = "Every other condition is compared with it, each by its own participants."
    else:
        why = "It is shown beside the ranked motions and not ranked: the real recording. Or empty."
    return InterviewQuestion("Reference", why)


WITH_REFERENCE: Final = ("pairwise", "ranking")
"""Templates that can have a reference."""


def source_descriptions() -> dict[str, str]:
    """Return the sources of motion and their descriptions; networks come last."""
    networks = [name for name in generator_names() if needs_model(name)]
    words = "generated here by a network from its weights: type {}"
    descriptions = {name: words.format(source_notation(name)) for name in networks}
    return {**SOURCE_DESCRIPTIONS, **descriptions}


def require_stated_pay(options: StudyOptions) -> None:
    """Raise `InputError` if a recruiting site would miss the pay or the duration."""
    if options.channel not in RECRUITING_SITES:
        return
    missing = [
        *([] if options.pay else ["the pay (--pay)"]),
        *([] if options.minutes else ["the minutes (--minutes)"]),
    ]
    if missing:
        raise InputError(
            f"recruiting sites must be told {' and '.join(missing)}", remedy="State that as well"
        )


def read_pay(text: str, channel: str | None) -> Pay | None:
    """Return the pay of each participant from ``AMOUNT CURRENCY``; None for no pay.

    Raises
    ------
    InputError
        If it is not an amount with a currency, or there is no pay on a recruiting site.
    """
    amount, _, currency = text.strip().replace(",", ".").partition(" ")
    if re.fullmatch(r"\d+(\.\d)?", amount):
        amount = f"{Decimal(amount):.2f}"
    if not re.fullmatch(MONEY, amount):
        raise InputError(f"{amount!r} is not an amount", remedy="Give one such as 2.50 EUR")
    if not amount or not Decimal(amount):
        if channel in RECRUITING_SITES:
            raise InputError("recruiting sites must be told the pay")
        return None
    currency = currency or ("USD" if channel == "mturk" else "")
    if not re.fullmatch(r"[A-Za-z]{3}", currency):
        raise InputError(
            f"{currency!r} is not a currency" if currency else "an amount needs a currency",
            remedy="Give its three letters after the amount, such as 2.50 EUR",
        )
    return Pay(amount=amount, currency=currency.upper())


def read_count(text: str, maximum: int, *, unit: str) -> int:
    """Return a number of `unit` from 1 to `maximum`, or raise `InputError`."""
    if not text.isdecimal() or not 1 <= int(text) <= maximum:
        raise InputError(
            f"{text!r} is not a number of {unit}",
            remedy=f"Give a whole number from 1 to {maximum}",
        )
    return int(text)


def read_line(text: str, max_length: int) -> str:
    """Return `text`, or raise `InputError` if it is too long."""
    if len(text) > max_length:
        raise InputError(f"the text is longer than {max_length} characters", remedy="Shorten it")
    return text


def read_address(text: str) -> str:
    """Return a contact; an empty one can be filled in later, an unusable one is refused."""
    if text and not reaches_somebody(text):
        raise InputError(
            f"{text!r} does not say how to reach anybody",
            remedy="Give an e-mail address, a web page or a phone number; or nothing for now",
        )
    return read_line(text, 200)
