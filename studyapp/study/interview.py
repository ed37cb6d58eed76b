"""The questions that a new study needs answered (`interview.toml`), and how answers are read."""

import re
import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Final

from generators.registry import GENERATORS, needs_model
from motion.errors import InputError
from studyapp.study.settings.recruitment import Pay
from studyapp.study.study_options import source_notation

MAX_MINUTES: Final = 240
"""Longest study that can be set up."""

MAX_PARTICIPANTS: Final = 10_000

_WORDS: Final = tomllib.loads(files(__package__).joinpath("interview.toml").read_text("utf-8"))

STAND_INS: Final[str] = _WORDS["stand_ins"]
LANGUAGES: Final[Mapping[str, str]] = _WORDS["languages"]
TEMPLATE_DESCRIPTIONS: Final[Mapping[str, str]] = _WORDS["templates"]
CHANNEL_DESCRIPTIONS: Final[Mapping[str, str]] = _WORDS["channels"]
FRAMING_DESCRIPTIONS: Final[Mapping[str, str]] = _WORDS["framings"]

_NETWORK: Final = "generated here by a network from its weights"

InterviewQuestion = Mapping[str, str]
"""The label of a question, and why it is asked."""

QUESTIONS: Final[Mapping[str, InterviewQuestion]] = _WORDS["questions"]

WITH_REFERENCE: Final = ("pairwise", "ranking")
"""Templates that can have a reference."""


def participants_question(template: str) -> InterviewQuestion:
    """Return the question about the number of participants."""
    scope = "for each comparison with the reference" if template == "pairwise" else "in all"
    question = QUESTIONS["participants"]
    return {"label": question["label"], "why": question["why"].format(scope=scope)}


def reference_question(template: str) -> InterviewQuestion:
    """Return the question about the reference."""
    return {"label": "Reference", "why": _WORDS["references"][template]}


def source_descriptions() -> dict[str, str]:
    """Return the sources of motion of a new study, as they are typed, and their descriptions."""
    summaries = {
        source_notation(name): _NETWORK if needs_model(name) else entry.summary
        for name, entry in GENERATORS.items()
    }
    described = {source: words for source, words in summaries.items() if words}
    return {**_WORDS["sources"], **described}


def read_pay(text: str) -> Pay | None:
    """Return the pay of each participant from ``AMOUNT CURRENCY``; None for an empty text.

    Raises
    ------
    InputError
        If it is not an amount with a currency.
    """
    if not text.strip():
        return None
    stated = re.fullmatch(r"(\d{1,6})(?:[.,](\d{1,2}))?\s+([A-Za-z]{3})", text.strip())
    if stated is None:
        raise InputError(
            f"{text!r} is not an amount with a currency", remedy="Give one such as 2.50 EUR"
        )
    whole, part, currency = stated.groups(default="")
    return Pay(amount=f"{whole}.{part:0<2}", currency=currency.upper())


def read_count(text: str, maximum: int, *, unit: str) -> int:
    """Return a number of `unit` from 1 to `maximum`, or raise `InputError`."""
    # Python converts no number of thousands of digits.
    is_number = text.isdecimal() and len(text) <= len(str(maximum))
    if not is_number or not 1 <= int(text) <= maximum:
        raise InputError(
            f"{text!r} is not a number of {unit}",
            remedy=f"Give a whole number from 1 to {maximum}",
        )
    return int(text)
