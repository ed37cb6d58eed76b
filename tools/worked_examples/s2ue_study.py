"""The published percentages of S2UE's user study (Bhattacharya et al. 2024, section 7)."""

from dataclasses import dataclass
from typing import Final

PARTICIPANTS: Final = 90
GROUPS: Final = 8
"""Motions of a condition that each participant rates in one set."""


@dataclass(frozen=True, kw_only=True)
class PrintedPercentage:
    """Share of participants, or of answers, that rated the method's own motions 3 or above.

    Attributes
    ----------
    question : str
        The question.
    set_number : int
        Number of the set.
    percent : float
        The printed percentage, with two decimals.
    """

    question: str
    set_number: int
    percent: float


DECIMALS: Final = 2

PERCENTAGES: Final = (
    PrintedPercentage(question="plausibility", set_number=1, percent=88.89),
    PrintedPercentage(question="plausibility", set_number=2, percent=80.00),
    PrintedPercentage(question="synchronisation", set_number=1, percent=65.46),
    PrintedPercentage(question="synchronisation", set_number=2, percent=62.87),
)
