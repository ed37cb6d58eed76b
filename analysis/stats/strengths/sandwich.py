"""Covariances of estimates that doubt the model, or that answers are independent."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]

ROOM: Final = 8
"""Cells of clusters and kinds, for each row, up to which empty ones are counted too."""


def sandwiches(
    bread: Floats, scores: Floats, kind: Codes, cluster: Codes, times: Codes | None = None
) -> tuple[Floats, Floats]:
    """Return the covariance robust to a wrong model (HC0), and the clustered one (CR0).

    Parameters
    ----------
    bread : ndarray, shape (k, k)
        Inverse of minus the log-likelihood's second derivatives.
    scores : ndarray, shape (kinds, k)
        Gradient of the log-likelihood of each kind of answer.
    kind, cluster : ndarray of int, shape (N,)
        Each answer's kind, and whose it is; from 0.
    times : ndarray of int, shape (N,), optional
        How many answers each row stands for; one each unless given.

    Returns
    -------
    tuple of ndarray, shape (k, k)
        The clustered one is NaN where there is one cluster: nothing tells how clusters differ.
    """
    weights = np.ones(len(kind)) if times is None else times.astype(np.float64)
    clusters, kinds = int(cluster.max(initial=-1)) + 1, len(scores)
    if clusters * kinds <= ROOM * len(kind):
        cells = cluster * kinds + kind
        flat = np.bincount(cells, weights=weights, minlength=clusters * kinds)
        by_cluster = np.asarray(flat.reshape(clusters, kinds) @ scores, np.float64)
    else:
        table = sparse.coo_matrix((weights, (cluster, kind)), shape=(clusters, kinds))
        by_cluster = np.asarray(table.tocsr() @ scores, np.float64)
    counts = np.bincount(kind, weights=weights, minlength=len(scores))[:, None]
    robust = bread @ (scores.T @ (counts * scores)) @ bread
    if not (cluster != cluster[:1]).any():
        return robust, np.full_like(bread, np.nan)
    return robust, bread @ (by_cluster.T @ by_cluster) @ bread
