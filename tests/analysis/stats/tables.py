"""Answers in tables, and votes by names, as tests write them."""

from collections.abc import Sequence
from itertools import chain

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from analysis.stats.strength_models import Votes
from motion.arrays import Floats, Indices


def cells(table: ArrayLike) -> tuple[Floats, Indices, Indices]:
    """Return the values of a table, with their rows and columns; NaN is missing."""
    values = np.asarray(table, np.float64)
    rows, columns = np.nonzero(~np.isnan(values))
    return values[rows, columns], rows, columns


def votes_of(
    left: Sequence[str],
    right: Sequence[str],
    outcome: Sequence[int],
    participant: Sequence[str],
    *,
    conditions: Sequence[str] = (),
    segment: Sequence[str] = (),
) -> Votes:
    """Return named answers as numbers; without `segment`, all are about one segment."""
    names = tuple(conditions) or tuple(dict.fromkeys(chain(*zip(left, right, strict=True))))
    return Votes(
        conditions=names,
        left=np.array([names.index(name) for name in left], np.intp),
        right=np.array([names.index(name) for name in right], np.intp),
        outcome=np.asarray(outcome, np.intp),
        participant=pd.factorize(np.asarray(participant, str), sort=True)[0],
        segment=pd.factorize(np.asarray(segment or ["s"] * len(left), str), sort=True)[0],
    )
