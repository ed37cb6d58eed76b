"""`[recruitment]`: where participants come from, their completion codes, and their pay."""

import secrets
from decimal import Decimal
from typing import Final, Literal

from pydantic import Field

from studyapp.study.settings.sections import CODE, CURRENCY, HOST, MONEY, Section

PROLIFIC_PLACEHOLDERS: Final = (
    "?PROLIFIC_PID={{%PROLIFIC_PID%}}&STUDY_ID={{%STUDY_ID%}}&SESSION_ID={{%SESSION_ID%}}"
)
"""Prolific fills these in for each participant."""

CODE_LETTERS: Final = "ABCDEFGHJKMNPQRTUVWXYZ2346789"
"""Letters and digits that are not mistaken for each other."""

CODE_LENGTH: Final = 12

GUESSABLE_WORDS: Final = (
    *("attention", "check", "code", "complete", "completed", "done", "finish", "motion", "pass"),
    *("prolific", "screen", "secret", "study", "success", "survey", "test", "thank", "fail"),
)

MIN_GUESSES: Final = 3 * 10**7
"""Prolific's own codes take 10 to the power of 8 guesses."""


def draw_code() -> str:
    """Return a random code of 58 bits."""
    return "".join(secrets.choice(CODE_LETTERS) for _ in range(CODE_LENGTH))


def is_guessable(code: str) -> bool:
    """Tell whether `code` takes too few guesses, as zxcvbn estimates them."""
    # Imported here: its words take long to load, and few studies have codes of their own.
    from zxcvbn import zxcvbn  # type: ignore[import-untyped]

    return bool(zxcvbn(code, GUESSABLE_WORDS)["guesses"] < MIN_GUESSES)


class Pay(Section):
    """The pay of a participant; the page's sentence about it is `Page.payment`.

    Attributes
    ----------
    amount : str
        Pay for finishing the study, such as ``"2.50"``. Recruiting sites have their own keys,
        which count there.
    currency : str
        Its currency, such as ``"EUR"``; on Prolific, that of the account.
    hourly_minimum : str
        The lowest hourly rate that your institution or the law allows, in that currency.
    """

    amount: str = Field("", pattern=MONEY)
    currency: str = Field("", pattern=CURRENCY)
    hourly_minimum: str = Field("", pattern=MONEY)

    @property
    def payment(self) -> Decimal | None:
        """The amount as a number; None if it is not stated."""
        return Decimal(self.amount) if self.amount else None

    @property
    def minimum(self) -> Decimal | None:
        """The hourly minimum as a number; None if it is not stated."""
        return Decimal(self.hourly_minimum) if self.hourly_minimum else None


def hourly_rate(amount: Decimal, minutes: float) -> float:
    """Return the rate of `amount` for so many minutes."""
    return float(amount) * 60 / minutes


def format_amount(amount: float | Decimal, currency: str) -> str:
    """Return an amount with its currency."""
    return f"{amount:.2f} {currency}".strip()


Channel = Literal["link", "prolific", "mturk", "invitations"]

Outcome = Literal["completed", "failed_attention", "unwatched"]
"""How a study session ended; ``unwatched`` early, because too many videos failed to play."""

MTURK_CURRENCY: Final = "USD"

LONG_STUDY_MINUTES: Final = 5
MIN_FAILED_CHECKS: Final = 2
"""A study at least this long may refuse pay only after so many failed attention checks."""

Code = Field("", max_length=32, pattern=CODE)


class Prolific(Section):
    """A study on Prolific; sent when the draft is created.

    Attributes
    ----------
    completed, screened_out, failed_attention : str
        The three completion codes; ``motionjury recruit STUDY codes`` draws them.
    reward : int
        Pay of each participant, in the smallest unit of the account's currency.
    description : str
        Description on Prolific; by default, the study's title.
    automatic : bool
        Whether finished participants are paid at once, without approval.
    signed_for : str
        The study's host, if Prolific signs the links of participants; otherwise empty.
    """

    completed: str = Code
    screened_out: str = Code
    failed_attention: str = Code
    reward: int = Field(0, ge=0)
    description: str = Field("", max_length=4000)
    automatic: bool = False
    signed_for: str = Field("", max_length=253, pattern=HOST)

    def code(self, outcome: Outcome) -> str:
        """Return the code of `outcome`."""
        return self.completed if outcome == "completed" else self.failed_attention

    @property
    def codes(self) -> dict[str, str]:
        """All three codes by key."""
        return self.model_dump(include={"completed", "screened_out", "failed_attention"})


class MTurk(Section):
    """A HIT on Mechanical Turk; sent when it is created.

    Attributes
    ----------
    reward : str
        Pay of each worker in US dollars, such as ``"3.50"``.
    description : str
        Helps workers to find the HIT.
    """

    reward: str = Field("", pattern=MONEY)
    description: str = Field("", max_length=2000)

    @property
    def dollars(self) -> Decimal:
        """The reward as a number."""
        return Decimal(self.reward or "0")


class Recruitment(Section):
    """Where participants come from, and who is paid.

    Attributes
    ----------
    channel : {'link', 'prolific', 'mturk', 'invitations'}
        ``link``: anybody with the study's address; each gets a personal completion code.
        ``invitations``: only people with a personal invitation.
    unpaid_failed_checks : int
        Participants who fail so many attention checks need not be paid; 0: everybody who finishes
        is paid. Catch trials never cost pay.
    newcomers_per_address : int
        The most participants who may begin within an hour from one network address, unless they
        have personal or signed links; 0 for no limit.
    """

    channel: Channel = "link"
    unpaid_failed_checks: int = Field(MIN_FAILED_CHECKS, ge=0, le=10)
    newcomers_per_address: int = Field(30, ge=0)
    pay: Pay = Pay()
    prolific: Prolific = Prolific()
    mturk: MTurk = MTurk()

    @property
    def amount(self) -> Decimal | None:
        """The pay of each participant; None if the channel's key for it is empty."""
        rewards = {"prolific": Decimal(self.prolific.reward) / 100, "mturk": self.mturk.dollars}
        return rewards.get(self.channel, self.pay.payment) or None

    @property
    def currency(self) -> str:
        """The currency of `amount`; empty if it is not stated."""
        return MTURK_CURRENCY if self.channel == "mturk" else self.pay.currency

    @property
    def names_participants(self) -> bool:
        """Whether the channel names everybody who takes part."""
        return self.channel != "link"

    def link(self, address: str) -> str:
        """Return the link to the study at `address`; empty if participants have personal ones."""
        if self.channel in ("invitations", "mturk"):
            return ""
        return address + (PROLIFIC_PLACEHOLDERS if self.channel == "prolific" else "")

    @property
    def is_proven(self) -> bool:
        """Whether all participants have personal or signed links."""
        is_signed = self.channel == "prolific" and self.prolific.signed_for != ""
        return is_signed or self.channel == "invitations"

    def outcome(self, failed_checks: int) -> Outcome:
        """Return the outcome of a finished study session under the payment rule."""
        if self.unpaid_failed_checks and failed_checks >= self.unpaid_failed_checks:
            return "failed_attention"
        return "completed"

    def problems(self, minutes: int | None) -> list[str]:
        """Return all contradictions between keys.

        Parameters
        ----------
        minutes : int or None
            The stated duration of the study.
        """
        is_short = minutes is not None and minutes < LONG_STUDY_MINUTES
        codes = {key: code for key, code in self.prolific.codes.items() if code}
        problems = [
            f"recruitment.prolific.{key}: the code could be guessed (draw one with 'motionjury "
            "recruit STUDY codes')"
            for key, code in codes.items()
            if is_guessable(code)
        ]
        if len(set(map(str.casefold, codes.values()))) < len(codes):
            problems.append("recruitment.prolific: two outcomes have the same code")
        if (self.pay.amount or self.pay.hourly_minimum) and not self.pay.currency:
            problems.append("recruitment.pay: an amount needs a currency")
        if self.channel == "mturk" and self.pay.currency not in ("", MTURK_CURRENCY):
            problems.append(
                f"recruitment.pay.currency: Mechanical Turk pays in {MTURK_CURRENCY}, not in "
                f"{self.pay.currency}"
            )
        if self.unpaid_failed_checks == 1 and not is_short:
            problems.append(
                "recruitment.unpaid_failed_checks: one failed check is not enough to refuse pay, "
                f"unless page.minutes is less than {LONG_STUDY_MINUTES} (use {MIN_FAILED_CHECKS} "
                "or more, or 0)"
            )
        return problems

    @property
    def missing_codes(self) -> list[str]:
        """Keys of the codes that the channel needs and that are empty."""
        if self.channel != "prolific":
            return []
        return [key for key, code in self.prolific.codes.items() if not code]
