"""Decodes the viewer's data, step by step as the docstring of `pack` describes."""

from __future__ import annotations

import json
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray


def unpacked(data: bytes) -> tuple[dict[str, Any], dict[str, NDArray[np.int16]]]:
    """Return the facts and the arrays of packed data."""
    content = zlib.decompress(data)
    start = 4 + int.from_bytes(content[:4], "little")
    facts = json.loads(content[4:start])
    arrays = {}
    for name, rows, columns in facts.pop("arrays"):
        count = rows * columns
        low, high = np.frombuffer(content, np.uint8, 2 * count, start).reshape(2, count)
        folded = low.astype(np.int64) + 256 * high.astype(np.int64)
        differences = np.where(folded % 2, -(folded + 1) // 2, folded // 2)
        values = np.cumsum(differences.reshape(columns, rows).T, axis=0)
        arrays[name] = values.astype(np.uint16).view(np.int16)
        start += 2 * count
    assert start == len(content)
    return facts, arrays
