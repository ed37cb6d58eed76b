"""What a result is about: it stands first wherever results are listed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class ConditionPlace:
    """One condition and one question.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    condition, question : str
        What it is about.
    """

    set: str | None
    condition: str
    question: str


@dataclass(frozen=True, kw_only=True)
class PairPlace:
    """Two conditions and one question: a against b, a being the one that appeared first.

    Attributes
    ----------
    set : str or None
        None where the table has no sets.
    a, b, question : str
        What it is about.
    """

    set: str | None
    a: str
    b: str
    question: str
