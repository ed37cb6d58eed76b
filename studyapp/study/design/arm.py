"""Arms: groups of places whose participants are asked about the same, and what they preferred."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

Tally = Mapping[tuple[str, str], float]
"""How often the first condition was preferred to the second; a tie is half a win for both."""

NO_VOTES: Final[Tally] = MappingProxyType({})


@dataclass(frozen=True, kw_only=True)
class Arm:
    """One group of places.

    Attributes
    ----------
    name : str
        Names it in the database, the export and the report.
    conditions : tuple of str
        What its participants compare, the reference first.
    places : int
        How many participants it takes.
    """

    name: str
    conditions: tuple[str, ...]
    places: int
