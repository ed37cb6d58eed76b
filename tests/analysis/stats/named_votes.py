"""Votes by names, as tests write them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analysis.stats.bradley_terry import Votes


def votes_of(
    left: Sequence[str],
    right: Sequence[str],
    outcome: Sequence[int],
    participant: Sequence[str],
    *,
    conditions: Sequence[str] = (),
    segment: Sequence[str] | None = None,
) -> Votes:
    """Return named answers as numbers; conditions in order of appearance unless given."""
    names = tuple(conditions) or tuple(
        dict.fromkeys(name for pair in zip(left, right, strict=True) for name in pair)
    )
    number = {name: place for place, name in enumerate(names)}
    people = np.unique(np.asarray(participant, str), return_inverse=True)[1]
    return Votes(
        conditions=names,
        left=np.array([number[name] for name in left], np.intp),
        right=np.array([number[name] for name in right], np.intp),
        outcome=np.asarray(outcome, np.intp),
        participant=people.astype(np.intp),
        segment=None
        if segment is None
        else np.unique(np.asarray(segment, str), return_inverse=True)[1].astype(np.intp),
    )
