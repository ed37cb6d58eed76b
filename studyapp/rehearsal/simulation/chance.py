"""Chance that can be asked again: a random stream for every named event of a rehearsal."""

from __future__ import annotations

import hashlib
import json
from functools import lru_cache

import numpy as np


def stream(seed: int, *event: str | int) -> np.random.Generator:
    """Return the random stream of one named event.

    The same seed and event always give the same stream, and no stream depends on which others
    were drawn before. A rehearsal therefore gives the same answers in whatever order its
    participants arrive, and whether or not it was interrupted.

    Parameters
    ----------
    seed : int
        Seed of the rehearsal.
    *event : str or int
        What happens: for example ``"taste", "static", "rhythm"``.
    """
    digest = hashlib.sha256(json.dumps([seed, *event]).encode()).digest()
    return np.random.default_rng(int.from_bytes(digest, "big"))


@lru_cache(maxsize=65_536)
def standard_normal(seed: int, *event: str | int) -> float:
    """Return the first draw of an event's stream from the standard normal distribution.

    For traits, which every answer asks for again.
    """
    return float(stream(seed, *event).standard_normal())
