"""`[recruitment]`: where participants come from, the codes they get, who is paid how much."""

from __future__ import annotations

import re
import secrets
from decimal import Decimal
from typing import Final, Literal

from pydantic import Field

from studyapp.study.settings.sections import Section

PROLIFIC_PLACEHOLDERS: Final = (
    "?PROLIFIC_PID={{%PROLIFIC_PID%}}&STUDY_ID={{%STUDY_ID%}}&SESSION_ID={{%SESSION_ID%}}"
)
"""What Prolific fills in for each participant."""

CODE_LETTERS: Final = "ABCDEFGHJKMNPQRTUVWXYZ2346789"
"""Letters and digits that are not taken for one another."""

CODE_LENGTH: Final = 12

MIN_CODE_LENGTH: Final = 8
MIN_DISTINCT_CHARACTERS: Final = 5
MAX_RUN: Final = 3
CHARACTER_SEQUENCES: Final = (
    "abcdefghijklmnopqrstuvwxyz",
    "01234567890",
    "qwertyuiop",
    "asdfghjkl",
    "zxcvbnm",
)
GUESSABLE_WORDS: Final = (
    *("attention", "check", "code", "complete", "done", "finish", "motion", "pass", "prolific"),
    *("screen", "secret", "study", "success", "survey", "test", "thank", "fail"),
)


def draw_code() -> str:
    """Return a code that nobody can guess (58 random bits)."""
    while True:
        code = "".join(secrets.choice(CODE_LETTERS) for _ in range(CODE_LENGTH))
        if code_weakness(code) is None:
            return code


def code_weakness(code: str) -> str | None:
    """Say why `code` could be guessed, None if it could not."""
    plain = code.casefold()
    if len(code) < MIN_CODE_LENGTH:
        return f"has fewer than {MIN_CODE_LENGTH} characters"
    if len(set(plain)) < MIN_DISTINCT_CHARACTERS:
        return f"has fewer than {MIN_DISTINCT_CHARACTERS} different characters"
    if word := next((word for word in GUESSABLE_WORDS if word in plain), None):
        return f"holds the word {word!r}"
    if _has_run(plain):
        return f"holds more than {MAX_RUN} characters in a row that follow one another"
    if re.fullmatch(r"(.+?)\1+", plain):
        return "repeats itself"
    return None


def _has_run(plain: str) -> bool:
    """Tell whether letters or digits stand together as in the alphabet or on a keyboard."""
    pieces = (plain[at : at + MAX_RUN + 1] for at in range(len(plain) - MAX_RUN))
    rows = (*CHARACTER_SEQUENCES, *(row[::-1] for row in CHARACTER_SEQUENCES))
    return any(len(set(piece)) == 1 or any(piece in row for row in rows) for piece in pieces)


MONEY: Final = r"^(\d{1,6}(\.\d{2})?)?$"
"""An amount such as ``2.50``; empty where nothing is said."""

CURRENCY: Final = r"^([A-Z]{3})?$"
"""Three letters (ISO 4217)."""


class Pay(Section):
    """What a participant gets; what the page says of it is `Page.payment`.

    Attributes
    ----------
    amount : str
        What who finishes gets, such as ``"2.50"``. Recruiting sites are told it under their own
        keys, which count there.
    currency : str
        Of the amount, three letters such as ``"EUR"``; on Prolific, of the account.
    hourly_minimum : str
        What an hour must pay at least, by your institution's rules or the law, in that currency.
    """

    amount: str = Field("", pattern=MONEY)
    currency: str = Field("", pattern=CURRENCY)
    hourly_minimum: str = Field("", pattern=MONEY)

    @property
    def payment(self) -> Decimal | None:
        """The amount as a number; None where it is not stated."""
        return Decimal(self.amount) if self.amount else None

    @property
    def minimum(self) -> Decimal | None:
        """The hourly minimum as a number; None where it is not stated."""
        return Decimal(self.hourly_minimum) if self.hourly_minimum else None

    def problems(self) -> list[str]:
        """Return what does not fit together."""
        stated = self.amount or self.hourly_minimum
        return (
            ["recruitment.pay: an amount needs a currency"] if stated and not self.currency else []
        )


def hourly_rate(amount: Decimal, minutes: float) -> float:
    """Return an amount for so many minutes as one for an hour."""
    return float(amount) * 60 / minutes


def format_amount(amount: float | Decimal, currency: str) -> str:
    """Return an amount as people read it."""
    return f"{amount:.2f} {currency}".strip()


Channel = Literal["link", "prolific", "mturk", "invitations"]

Outcome = Literal["completed", "failed_attention", "unwatched"]
"""How a study session ended; ``unwatched`` before its last trial, since too many videos failed."""

LONG_STUDY_MINUTES: Final = 5
MIN_FAILED_CHECKS: Final = 2
"""A study this long may refuse pay only after so many failed attention checks."""

Code = Field("", max_length=32, pattern=r"^[A-Za-z0-9_-]*$")


class Prolific(Section):
    """A study on Prolific. What is paid and asked for is sent when the draft is made.

    Attributes
    ----------
    completed, screened_out, failed_attention : str
        The study's three codes; ``motionjury recruit STUDY codes`` draws them.
    reward : int
        What each participant gets, in the smallest unit of the account's currency.
    places : int or None
        How many participants; None for as many as the study has places.
    description : str
        What participants read on Prolific; the study's title without it.
    automatic : bool
        Whether who finishes is paid at once, without being approved.
    screened_out_reward, screened_out_places : int
        What each of at most so many who are screened out gets; 0 where they are asked to return.
    project : str
        The Prolific project; the account's default without it.
    signed_for : str
        The host that participants reach the study at, where Prolific signs who comes; empty where
        it does not.
    """

    completed: str = Code
    screened_out: str = Code
    failed_attention: str = Code
    reward: int = Field(0, ge=0)
    places: int | None = Field(None, ge=1)
    description: str = Field("", max_length=4000)
    automatic: bool = False
    screened_out_reward: int = Field(0, ge=0)
    screened_out_places: int = Field(0, ge=0)
    project: str = Field("", max_length=100)
    signed_for: str = Field("", max_length=253, pattern=r"^([a-z0-9-]+(\.[a-z0-9-]+)+)?$")

    def code(self, outcome: Outcome) -> str:
        """Return the code of `outcome`."""
        return self.completed if outcome == "completed" else self.failed_attention

    @property
    def codes(self) -> dict[str, str]:
        """All three codes, by their keys."""
        return {
            "completed": self.completed,
            "screened_out": self.screened_out,
            "failed_attention": self.failed_attention,
        }


class MTurk(Section):
    """A HIT on Mechanical Turk. What is paid and asked for is sent when it is made.

    Attributes
    ----------
    reward : str
        US dollars each worker gets, such as ``"3.50"``.
    assignments : int or None
        How many workers; None for as many as the study has places.
    description, keywords : str
        What workers find the HIT by.
    hours_to_accept, days_to_review : int
        How long the HIT is offered, and after how long an assignment is paid unreviewed.
    """

    reward: str = Field("", pattern=r"^(\d{1,4}\.\d{2})?$")
    assignments: int | None = Field(None, ge=1)
    description: str = Field("", max_length=2000)
    keywords: str = Field("video, animation, opinion", max_length=1000)
    hours_to_accept: int = Field(72, ge=1, le=8760)
    days_to_review: int = Field(7, ge=1, le=30)

    @property
    def dollars(self) -> Decimal:
        """The reward as a number."""
        return Decimal(self.reward or "0")


class Recruitment(Section):
    """Where participants come from, and who of them is paid.

    Attributes
    ----------
    channel : {'link', 'prolific', 'mturk', 'invitations'}
        ``link``: whoever has the study's address, each with a completion code of their own.
        ``invitations``: only who has an invitation that was made for them.
    unpaid_failed_checks : int
        Who fails at least so many attention checks need not be paid; 0: who finishes is paid,
        whatever they answered. Catch trials never cost pay.
    newcomers_per_address : int
        How many may begin within an hour from one network address, unless each has a link that was
        made or signed for them; 0 for any number.
    pay : Pay
        What each of them gets.
    """

    channel: Channel = "link"
    unpaid_failed_checks: int = Field(MIN_FAILED_CHECKS, ge=0, le=10)
    newcomers_per_address: int = Field(30, ge=0)
    pay: Pay = Pay()
    prolific: Prolific = Prolific()
    mturk: MTurk = MTurk()

    @property
    def amount(self) -> Decimal | None:
        """What each participant gets; None where the channel's key for it is empty."""
        stated = {
            "prolific": Decimal(self.prolific.reward) / 100,
            "mturk": self.mturk.dollars,
        }.get(self.channel, self.pay.payment)
        return stated or None

    @property
    def currency(self) -> str:
        """Of the amount; empty where nobody said which."""
        return "USD" if self.channel == "mturk" else self.pay.currency

    @property
    def names_participants(self) -> bool:
        """Whether nobody takes part whom the channel does not name."""
        return self.channel != "link"

    def link(self, address: str) -> str:
        """Return the link that brings participants to `address`; empty where each has their own."""
        if self.channel in ("invitations", "mturk"):
            return ""
        return address + (PROLIFIC_PLACEHOLDERS if self.channel == "prolific" else "")

    @property
    def is_proven(self) -> bool:
        """Whether everybody comes with a link that was made or signed for them."""
        signed = self.channel == "prolific" and self.prolific.signed_for != ""
        return signed or self.channel == "invitations"

    def outcome(self, failed_checks: int) -> Outcome:
        """Return what the recruiter is told of who finished, by the payment rule."""
        if self.unpaid_failed_checks and failed_checks >= self.unpaid_failed_checks:
            return "failed_attention"
        return "completed"

    def problems(self, minutes: int | None) -> list[str]:
        """Return what cannot be right, whatever the channel.

        Parameters
        ----------
        minutes : int or None
            How long the study says it takes.
        """
        short = minutes is not None and minutes < LONG_STUDY_MINUTES
        paid = self.prolific
        codes = {key: code for key, code in paid.codes.items() if code}
        problems = [
            f"recruitment.prolific.{key}: the code {problem} (draw one with 'motionjury "
            "recruit STUDY codes')"
            for key, code in codes.items()
            if (problem := code_weakness(code)) is not None
        ]
        if len(set(map(str.casefold, codes.values()))) < len(codes):
            problems.append("recruitment.prolific: two outcomes have the same code")
        problems += self.pay.problems()
        if self.unpaid_failed_checks == 1 and not short:
            problems.append(
                "recruitment.unpaid_failed_checks: one failed check is no ground for refusing pay, "
                "unless page.minutes says that the study takes less than "
                f"{LONG_STUDY_MINUTES} (use {MIN_FAILED_CHECKS} or more, or 0)"
            )
        if bool(paid.screened_out_reward) != bool(paid.screened_out_places):
            problems.append(
                "recruitment.prolific: screened_out_reward and screened_out_places need each other"
            )
        if paid.screened_out_reward and paid.screened_out_reward >= paid.reward:
            problems.append("recruitment.prolific: screened_out_reward must be less than reward")
        return problems

    @property
    def missing_codes(self) -> list[str]:
        """Keys of the codes without which the channel's participants cannot be told the end."""
        if self.channel != "prolific":
            return []
        return [key for key, code in self.prolific.codes.items() if not code]
