"""The four protocols' tables."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

import numpy as np
import pandas as pd

from analysis.answers.columns import PREFERENCE, RANK, RATING, name_column, speech_column
from analysis.answers.layout import Layout, Rows, nothing_wrong


def _same(answers: pd.DataFrame, left: str, right: str) -> Rows:
    return np.asarray(answers[left].astype(object) == answers[right].astype(object), bool)


PAIRWISE: Final = Layout(
    protocol="pairwise",
    conditions=(name_column("left"), name_column("right")),
    value=PREFERENCE,
    has_sides=True,
    wrong=lambda answers: _same(answers, "left", "right"),
    contradiction="left and right are the same condition",
)

RATING_OF_ONE: Final = Layout(
    protocol="rating",
    conditions=(name_column("condition"),),
    value=RATING,
    has_sides=False,
    wrong=nothing_wrong,
)

RANKING: Final = Layout(
    protocol="ranking",
    conditions=(name_column("condition"),),
    value=RANK,
    has_sides=False,
    answered_once=True,
    wrong=nothing_wrong,
)

MISMATCH: Final = Layout(
    protocol="mismatch",
    conditions=(name_column("condition"),),
    value=PREFERENCE,
    others=(speech_column("left_speech"), speech_column("right_speech")),
    has_sides=True,
    wrong=lambda answers: _same(answers, "left_speech", "right_speech"),
    contradiction="left_speech and right_speech are the same; one is own, the other is other",
)

LAYOUTS: Final[Mapping[str, Layout]] = MappingProxyType(
    {layout.protocol: layout for layout in (PAIRWISE, RATING_OF_ONE, RANKING, MISMATCH)}
)
"""By the name that the command line takes."""
