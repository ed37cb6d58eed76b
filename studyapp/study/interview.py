"""What is asked of a new study, and how answers are read."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from decimal import Decimal
from types import MappingProxyType
from typing import Final

from generators.registry import generator_names, needs_model
from motion.errors import InputError
from studyapp.study.condition_options import FILES, VIDEOS, source_notation
from studyapp.study.settings.presentation import reaches_somebody
from studyapp.study.settings.recruitment import MONEY, Pay
from studyapp.study.study_options import StudyOptions

MAX_MINUTES: Final = 240
"""Minutes that a study may take."""

MAX_PARTICIPANTS: Final = 10_000

RECRUITING_SITES: Final = ("prolific", "mturk")
"""Channels that must be told what participants get and how long it takes."""

TEMPLATE_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "pairwise": "two motions of the same speech side by side: which one is preferred? As in "
        "AMUSE; for few conditions and small differences",
        "rating": "several motions of one speech on a page, each rated on a scale. As in S2UE; for "
        "absolute judgements of many conditions",
        "ranking": "several motions of one speech put in order, beside the recording. As in "
        "DiffSHEG; for many conditions that plainly differ",
        "mismatch": "one motion with its own and with another speech: which fits? As in GENEA; "
        "whether motion follows speech at all",
        "three-systems": "AMUSE, DiffSHEG and Speech2UnifiedExpressions beside rules, mismatched "
        "motion and the recording, in pairs; for networks that you have",
    }
)

LANGUAGES: Final[Mapping[str, str]] = MappingProxyType(
    {"en": "English", "de": "German", "ja": "Japanese"}
)

CHANNEL_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "link": "anybody who has the study's address; everyone who finishes gets a code",
        "invitations": "people you write to; each gets a link of their own",
        "prolific": "people from Prolific; drafts, places and pay go through its API",
        "mturk": "workers of Mechanical Turk, if you are a requester there already",
    }
)

SOURCE_DESCRIPTIONS: Final[Mapping[str, str]] = MappingProxyType(
    {
        FILES: "motion files brought in with 'motionjury import': recordings, a system's output",
        VIDEOS: "finished videos in videos/NAME/; nothing is rendered",
        "rule_based": "made here from the speech: beat gestures by rule",
        "static": "made here: stands still",
        "mismatched": "another condition's motion for another speech: right in kind, wrong in time",
    }
)


@dataclass(frozen=True)
class InterviewQuestion:
    """One question: what is wanted, and what it is for."""

    label: str
    why: str


QUESTIONS: Final[Mapping[str, InterviewQuestion]] = MappingProxyType(
    {
        "template": InterviewQuestion(
            "Protocol", "What do participants do? Everything else follows from it."
        ),
        "language": InterviewQuestion(
            "Language",
            "In which language are the participants' pages, the questions and the consent text?",
        ),
        "conditions": InterviewQuestion(
            "Conditions",
            "Conditions are the systems that are compared. Name your own; or begin with stand-ins "
            "that are made here, to try everything before your motion is there.",
        ),
        "catch_videos": InterviewQuestion(
            "Will you bring videos of a broken motion",
            "Catch trials show a visibly broken motion beside a good one, to find who does not "
            "watch. Nothing here can break finished videos: bring broken ones in "
            "videos/broken/. Without them, the study has attention checks instead.",
        ),
        "channel": InterviewQuestion(
            "Recruiting",
            "Where do participants come from? It can be changed while the study runs.",
        ),
        "pay": InterviewQuestion(
            "Pay",
            "What does each participant get, as an amount with a currency such as 2.50 EUR? On "
            "Prolific in that of your account, GBP or USD, on Mechanical Turk in USD. It is told "
            "to participants, and 'motionjury check' says what an hour pays.",
        ),
        "minutes": InterviewQuestion(
            "Minutes",
            "How many minutes does it take? 'motionjury check' reckons it from your videos and "
            "questions, and says where this is wrong.",
        ),
        "title": InterviewQuestion(
            "Title",
            "What do participants see as the study's title? It should not tell what you expect.",
        ),
        "organisation": InterviewQuestion(
            "Institution", "Who runs the study? Participants read it before they agree."
        ),
        "contact": InterviewQuestion(
            "Contact", "Whom can they ask? An e-mail address that somebody reads."
        ),
        "ethics": InterviewQuestion(
            "Ethics",
            "Who approved the study? The committee and its number; empty if that is still to come.",
        ),
    }
)
STAND_INS: Final = (
    "motion that is made here: rule-based and mismatched; for ratings and rankings also still and "
    "flawed motion, for three-systems also the three networks"
)


def participants_question(template: str) -> InterviewQuestion:
    """Return the question for how many take part."""
    each = "for each comparison with the reference" if template == "pairwise" else "in all"
    return InterviewQuestion(
        "Participants",
        f"How many take part, {each}? The published study had the number given here; 'motionjury "
        "plan' says how many a difference needs.",
    )


def reference_question(template: str) -> InterviewQuestion:
    """Return the question for the reference, of templates that have one."""
    if template == "pairwise":
        why = "Every other condition is compared with the reference, each by people of its own."
    else:
        why = (
            "The reference is shown apart as a yardstick and not ranked: the real recording. "
            "Empty for none."
        )
    return InterviewQuestion("Reference", why)


WITH_REFERENCE: Final = ("pairwise", "ranking")
"""Templates whose own conditions may have a reference."""


def source_descriptions() -> dict[str, str]:
    """Return where motion comes from, each with what it means; networks come last."""
    networks = [name for name in generator_names() if needs_model(name)]
    words = "made here by a network from its weights: type {}"
    return {
        **SOURCE_DESCRIPTIONS,
        **{name: words.format(source_notation(name)) for name in networks},
    }


def require_stated_pay(wanted: StudyOptions) -> None:
    """Raise `InputError` where a recruiting site would not be told what it must be."""
    if wanted.channel not in RECRUITING_SITES:
        return
    missing = [
        *([] if wanted.pay else ["the pay (--pay)"]),
        *([] if wanted.minutes else ["the minutes (--minutes)"]),
    ]
    if missing:
        raise InputError(
            f"recruiting sites must be told {' and '.join(missing)}", remedy="State that as well"
        )


def read_pay(text: str, channel: str | None) -> Pay | None:
    """Return what each participant gets from ``AMOUNT CURRENCY``, None for nothing.

    Raises
    ------
    InputError
        If it is not an amount with a currency, or nothing though the channel is a recruiting site.
    """
    amount, _, currency = text.strip().replace(",", ".").partition(" ")
    if re.fullmatch(r"\d+(\.\d)?", amount):
        amount = f"{Decimal(amount):.2f}"
    if not re.fullmatch(MONEY, amount):
        raise InputError(f"{amount!r} is not an amount", remedy="Give one such as 2.50 EUR")
    if not amount or not Decimal(amount):
        if channel in RECRUITING_SITES:
            raise InputError("recruiting sites must be told what participants get")
        return None
    currency = currency or ("USD" if channel == "mturk" else "")
    if not re.fullmatch(r"[A-Za-z]{3}", currency):
        raise InputError(
            f"{currency!r} is not a currency" if currency else "an amount needs a currency",
            remedy="Give its three letters after the amount, such as 2.50 EUR",
        )
    return Pay(amount=amount, currency=currency.upper())


def read_count(text: str, most: int, *, what: str) -> int:
    """Return a whole number of `what` from 1 to `most`; `InputError` where it is none."""
    if not text.isdecimal() or not 1 <= int(text) <= most:
        raise InputError(
            f"{text!r} is not a number of {what}", remedy=f"Give a whole number from 1 to {most}"
        )
    return int(text)


def read_line(text: str, longest: int) -> str:
    """Return what was typed; `InputError` where it is too long."""
    if len(text) > longest:
        raise InputError(f"that is longer than {longest} characters", remedy="Say it shorter")
    return text


def read_address(text: str) -> str:
    """Return a contact; one that reaches nobody is refused, none at all can be filled in later."""
    if text and not reaches_somebody(text):
        raise InputError(
            f"{text!r} does not say how to reach anybody",
            remedy="Give an e-mail address, a page or a telephone number; or nothing for now",
        )
    return read_line(text, 200)
