"""What comparisons can tell of strengths: who is linked to whom, and who never lost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from motion.listing import listed


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """How conditions are linked by comparisons.

    Attributes
    ----------
    tiers : ndarray of int, shape (conditions,)
        Conditions of one tier are linked by wins both ways. Of two tiers, one never lost to the
        other: their difference has no finite maximum-likelihood estimate (Ford 1957).
    apart : str
        Why there is no common scale, naming the groups that were never compared with one
        another; empty where all are linked.
    swept : str
        Which conditions never lost to which; empty where there is one tier.
    """

    tiers: NDArray[np.intp]
    apart: str
    swept: str


def links(beats: NDArray[np.float64], names: Sequence[str]) -> Links:
    """Return how conditions are linked.

    Parameters
    ----------
    beats : ndarray, shape (conditions, conditions)
        How often the row's condition was preferred to the column's; a tie counts for both.
    names : sequence of str
        The conditions' names.
    """
    groups, group = connected_components(csr_matrix(beats + beats.T), directed=False)
    count, tiers = connected_components(csr_matrix(beats), directed=True, connection="strong")
    apart = ""
    if groups > 1:
        parts = [_named(names, group == number) for number in range(groups)]
        apart = (
            f"never compared with one another, not even through others: {' | '.join(parts)}; "
            "strengths have no common scale"
        )
    swept = []
    for number in range(count if count > 1 and not apart else 0):
        inside = tiers == number
        if not beats[~inside][:, inside].any():
            swept.append(f"{_named(names, inside)} never lost to any of the others")
    return Links(tiers=np.asarray(tiers, np.intp), apart=apart, swept="; ".join(swept))


def _named(names: Sequence[str], chosen: NDArray[np.bool_]) -> str:
    return listed([name for name, yes in zip(names, chosen, strict=True) if yes])
