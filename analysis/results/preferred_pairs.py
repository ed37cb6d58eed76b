"""Pairs of clips that were preferred most and least, so that a reader can look at them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.table import AnswerTable
from analysis.results.grouping import shown_codes
from analysis.results.net_preference import sided

MOST_PAIRS: Final = 12
"""Pairs that a reader looks at; of more, those at both ends of the order are kept."""

_CELL: Final = ["first", "second", "segment"]


@dataclass(frozen=True, kw_only=True)
class PreferredPair:
    """Two clips of one segment, and how often the first was preferred.

    Attributes
    ----------
    segment, first, second : str
        Segment and conditions; the first is the one that comes first in the table.
    win_shares : mapping of str to float
        By question, in [0, 1], ties counting one half.
    answers : mapping of str to int
        How many each share rests on.
    """

    segment: str
    first: str
    second: str
    win_shares: Mapping[str, float]
    answers: Mapping[str, int]


def preferred_pairs(table: AnswerTable, analysed: pd.DataFrame) -> tuple[PreferredPair, ...]:
    """Return, for every two conditions, the segments in which the first won most and least.

    They are sorted by the win share on the table's first question, the highest first. Of ratings
    and rankings, the clip that a participant placed higher won. A mismatch task has no pairs,
    since nobody compares conditions there.

    Parameters
    ----------
    table : AnswerTable
        The answers.
    analysed : DataFrame
        Those of them that are analysed.
    """
    if table.protocol == "mismatch" or analysed.empty:
        return ()
    wins = (
        _pair_wins(analysed)
        if table.protocol == "pairwise"
        else _placed_wins(table.protocol, analysed)
    )
    shares = wins.groupby([*_CELL, "question"], sort=False)["win"].agg(["mean", "size"])
    shares = shares.reset_index()
    first_question = shares[shares["question"] == table.questions[0]]
    ordered = first_question.sort_values(["mean", *_CELL], ascending=[False, True, True, True])
    by_pair = ordered.groupby(["first", "second"])
    ends = ordered[ordered.index.isin([*by_pair.head(1).index, *by_pair.tail(1).index])]
    if len(ends) > MOST_PAIRS:
        ends = pd.concat([ends.head(MOST_PAIRS // 2), ends.tail(MOST_PAIRS // 2)])
    return tuple(_pair(table, cell, shares) for cell in ends[_CELL].itertuples(index=False))


def _pair(table: AnswerTable, cell: tuple[int, int, str], shares: pd.DataFrame) -> PreferredPair:
    first, second, segment = cell
    rows = shares[(shares[_CELL] == list(cell)).all(axis=1)]
    questions = rows["question"].tolist()
    return PreferredPair(
        segment=segment,
        first=table.conditions[first],
        second=table.conditions[second],
        win_shares=dict(zip(questions, rows["mean"].tolist(), strict=True)),
        answers=dict(zip(questions, rows["size"].tolist(), strict=True)),
    )


def _pair_wins(answers: pd.DataFrame) -> pd.DataFrame:
    """Return whether the first of two videos shown together won, a row for each answer."""
    pair = shown_codes(answers)
    return pd.DataFrame(
        {
            "first": pair["a"],
            "second": pair["b"],
            "segment": answers["segment"].astype(str),
            "question": answers["question"].astype(str),
            "win": sided(answers).wins,
        }
    )


def _placed_wins(protocol: str, answers: pd.DataFrame) -> pd.DataFrame:
    """Return whether the first won of every two clips that a participant rated or ranked."""
    together = ["participant", "set", "segment", "question"]
    placed = pd.DataFrame(
        {
            **{name: answers[name].astype(str) for name in together},
            "condition": shown_codes(answers)["condition"],
            "value": answers["value"].to_numpy(float) * (-1 if protocol == "ranking" else 1),
        }
    )
    both = placed.merge(placed, on=together, suffixes=("_first", "_second"))
    both = both[both["condition_first"] < both["condition_second"]]
    return pd.DataFrame(
        {
            "first": both["condition_first"],
            "second": both["condition_second"],
            "segment": both["segment"],
            "question": both["question"],
            "win": (np.sign(both["value_first"] - both["value_second"]) + 1) / 2,
        }
    )
