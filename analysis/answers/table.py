"""A checked table of answers, whatever protocol they were given in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import pandas as pd


@dataclass(frozen=True, kw_only=True, eq=False)
class AnswerTable:
    """Answers that can be relied on.

    Attributes
    ----------
    protocol : str
        How they were asked for.
    answers : DataFrame
        One row for each answer of practice, main, repeated and catch trials, and of attention
        checks that say what they ask for: `participant`, `segment`, `question`, `set`, `kind`,
        `trial`, `correct_side` and the protocol's columns as categories, NaN where a cell is
        empty; `value`, the answer; `instructed`, the one that an attention check asks for;
        `seconds`, how long it took; `watched`, the share of the trial's videos that was watched
        before it, in [0, 1]; NaN where that is not known.
    participants : tuple of str
        Everybody who is in the table, in the order of appearance.
    marked : dict of str to str
        Who is marked as excluded, and why.
    conditions, questions, sets : tuple of str
        Of main and repeated trials, in the order of appearance in the table; the only set is
        '' where there is no such column.
    notes : tuple of str
        What the table holds that is not analysed, or looks like a slip, in sentences.
    scales : mapping of str to (int, int)
        The lowest and the highest rating that each question allows, where that is known.
    """

    protocol: str
    answers: pd.DataFrame
    participants: tuple[str, ...]
    marked: dict[str, str]
    conditions: tuple[str, ...]
    questions: tuple[str, ...]
    sets: tuple[str, ...]
    notes: tuple[str, ...]
    scales: Mapping[str, tuple[int, int]] = field(default_factory=dict)

    @property
    def has_sets(self) -> bool:
        """Whether the answers are kept apart by set."""
        return self.sets not in ((), ("",))

    @property
    def shown(self) -> pd.DataFrame:
        """Answers of practice, main and repeated trials."""
        return self.answers[~self.answers["kind"].isin(["catch", "attention"])]
