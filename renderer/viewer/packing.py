"""Compact encoding of small integers for browsers.

What follows each other differs little, in motion as on a mesh. So the differences are kept, and
those that are small have a first byte only: the others are all zero, which deflate makes nothing
of. Browsers inflate by themselves.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

LARGEST: Final = 32_767
"""Largest integer that an array may hold; the smallest is its opposite."""


def quantise(values: NDArray[np.floating], step: float) -> tuple[NDArray[np.int16], float]:
    """Return `values` in steps, and the step.

    Parameters
    ----------
    values : ndarray
        Finite numbers.
    step : float
        The requested step; it is enlarged if the values would not fit.

    Returns
    -------
    (ndarray of int16, float)
        Of the values' shape; times the step they are at most half a step from the values.
    """
    step = max(step, float(np.abs(values).max(initial=0)) / LARGEST)
    return np.round(values / step).astype(np.int16), step


def pack(facts: Mapping[str, Any], arrays: Mapping[str, NDArray[np.integer]]) -> bytes:
    """Return facts and arrays as zlib data.

    Inside are the length of a header as four bytes, lowest first; the header in JSON, with the
    facts and, under ``arrays``, name, rows and columns of each array; then the arrays. Each is
    written column after column as differences modulo 65,536 from the row before, those below zero
    folded between the others (0, -1, 1, -2 … become 0, 1, 2, 3 …): all low bytes, then all high
    ones.

    Parameters
    ----------
    facts : mapping
        JSON values.
    arrays : mapping of str to ndarray
        Shape (rows, columns), values from -32,767 to 65,535.
    """
    shapes = [[name, *values.shape] for name, values in arrays.items()]
    header = json.dumps({**facts, "arrays": shapes}, separators=(",", ":")).encode()
    chunks = [len(header).to_bytes(4, "little"), header]
    for values in arrays.values():
        differences = np.diff(values.astype(np.uint16), axis=0, prepend=np.uint16(0))
        signed = differences.view(np.int16).T
        folded = ((signed << 1) ^ (signed >> 15)).view(np.uint16)
        chunks += [part.astype(np.uint8).tobytes() for part in (folded & 0xFF, folded >> 8)]
    return zlib.compress(b"".join(chunks), level=9)
