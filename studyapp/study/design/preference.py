"""Preferences between the two stimuli of a trial, as numbers around 0."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final, Literal

from studyapp.study.design.asking import Answers

Levels = Literal[2, 3, 5]

PREFERENCES: Final[Mapping[int, Sequence[int]]] = MappingProxyType(
    {2: (-1, 1), 3: (-1, 0, 1), 5: (-2, -1, 0, 1, 2)}
)
"""By how many answers there are: below 0 for the first stimulus (A), above for the second (B)."""


def prefer_side(answers: Answers, number: int) -> bool:
    """Tell whether every answer prefers stimulus `number`, which is 1 or 2, however little."""
    return all((value > 0) if number == 2 else (value < 0) for value in answers.values())
