"""Whether strengths can be estimated at all: everybody must be linked to everybody by wins."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from motion.listing import listed


def why_not_identified(beats: NDArray[np.float64], names: Sequence[str]) -> str:
    """Say why no finite strengths exist; empty where they do.

    They exist if, however the conditions are split in two groups, some condition of each group
    was at least once preferred to, or tied with, one of the other (Ford 1957).

    Parameters
    ----------
    beats : ndarray, shape (conditions, conditions)
        How often the row's condition was preferred to the column's; a tie counts for both.
    names : sequence of str
        The conditions' names.
    """
    met = csr_matrix(beats + beats.T)
    groups, group = connected_components(met, directed=False)
    if groups > 1:
        apart = listed([name for name, of in zip(names, group, strict=True) if of == group[0]])
        return f"{apart} was never compared with the others, so that strengths have no common scale"
    classes, of_class = connected_components(csr_matrix(beats), directed=True, connection="strong")
    if classes == 1:
        return ""
    for number in range(classes):
        inside = of_class == number
        if not beats[~inside][:, inside].any():
            better = listed([name for name, yes in zip(names, inside, strict=True) if yes])
            return f"{better} never lost to any of the others: the strength has no upper limit"
    raise AssertionError("a class that nobody beats always exists")
