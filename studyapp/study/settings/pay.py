"""`[recruitment.pay]`: what a participant gets, in numbers that can be reckoned with."""

from __future__ import annotations

from decimal import Decimal
from typing import Final

from pydantic import Field

from studyapp.study.settings.section import Section

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
    def each(self) -> Decimal | None:
        """The amount as a number; None where it is not stated."""
        return Decimal(self.amount) if self.amount else None

    @property
    def least(self) -> Decimal | None:
        """The hourly minimum as a number; None where it is not stated."""
        return Decimal(self.hourly_minimum) if self.hourly_minimum else None

    def problems(self) -> list[str]:
        """Return what does not fit together."""
        stated = self.amount or self.hourly_minimum
        return (
            ["recruitment.pay: an amount needs a currency"] if stated and not self.currency else []
        )


def hourly(amount: Decimal, minutes: float) -> float:
    """Return an amount for so many minutes as one for an hour."""
    return float(amount) * 60 / minutes


def money(amount: float | Decimal, currency: str) -> str:
    """Return an amount as people read it."""
    return f"{amount:.2f} {currency}".strip()
