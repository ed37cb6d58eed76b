"""Votes by names, as tests write them."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np
import pandas as pd

from analysis.stats.strength_models import Votes


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
