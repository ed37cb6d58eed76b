"""Arms: groups of places whose participants are asked about the same conditions."""

from __future__ import annotations

from dataclasses import dataclass


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
