"""Samples of embeddings: cut to equal sizes, and resampled clip by clip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.arrays import Floats, Ints

SEED: Final = 0
"""Seed of every draw, so that two runs give equal numbers."""

FEWEST_CLIPS: Final = 5
"""Fewer clips than this do not show how scores vary between samples of clips."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Embeddings:
    """A feature network's embeddings of the clips of one condition.

    Attributes
    ----------
    values : ndarray, shape (n, d)
        One row per clip, or per window of a clip.
    clips : ndarray, shape (n,), int
        Index of each row's clip, from 0 without gaps; rows of one clip are not independent.
    """

    values: Floats
    clips: Ints

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.values)

    def rows(self, index: Ints) -> Embeddings:
        """Return the rows at `index`."""
        clips = np.unique(self.clips[index], return_inverse=True)[1].astype(np.int64)
        return Embeddings(values=self.values[index], clips=clips)


def embeddings(values: Floats, clips: Sequence[object] | None = None) -> Embeddings:
    """Return embeddings with their clips numbered.

    Parameters
    ----------
    values : ndarray, shape (n, d)
        Embeddings.
    clips : sequence of n names, optional
        The clip of each row; by default each row is a separate clip.
    """
    if clips is None:
        return Embeddings(values=values, clips=np.arange(len(values)))
    numbers = {name: number for number, name in enumerate(dict.fromkeys(clips))}
    return Embeddings(values=values, clips=np.array([numbers[name] for name in clips], np.int64))


def of_equal_size(x: Embeddings, y: Embeddings) -> tuple[Embeddings, Embeddings]:
    """Return both samples with as many rows as the smaller one, drawn without replacement.

    The bias of a Fréchet distance depends on both sizes, so scores of unequal samples are not
    comparable.
    """
    count = min(len(x), len(y))
    return drawn(x, count), drawn(y, count)


def drawn(sample: Embeddings, count: int) -> Embeddings:
    """Return `count` rows of a sample, drawn without replacement, in their order."""
    if len(sample) == count:
        return sample
    chosen = np.random.default_rng(SEED).choice(len(sample), count, replace=False)
    return sample.rows(np.sort(chosen))


def resampled_clips(sample: Embeddings, count: int, seed: int) -> Iterator[Ints]:
    """Yield the rows of `count` bootstrap samples of whole clips."""
    chance = np.random.default_rng(seed)
    order = np.argsort(sample.clips, kind="stable")
    rows = np.split(order, np.flatnonzero(np.diff(sample.clips[order])) + 1)
    for _ in range(count):
        drawn = chance.integers(len(rows), size=len(rows))
        yield np.concatenate([rows[number] for number in drawn])
