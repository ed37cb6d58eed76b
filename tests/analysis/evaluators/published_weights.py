"""Checkpoints of published networks, of seeded weights."""

from __future__ import annotations

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from analysis.evaluators.published_presets import PRESETS


def seeded_weights(shapes: Mapping[str, Sequence[int]], salt: str = "") -> dict[str, Tensor]:
    """Return the weights with which the reference's networks were asked."""
    weights = {}
    for name, shape in shapes.items():
        random = np.random.default_rng(zlib.crc32((salt + name).encode()))
        weight = 0.05 * random.standard_normal(tuple(shape))
        if name.endswith("running_var"):
            weight = 1 + np.abs(weight)
        elif name.endswith(".weight") and len(shape) == 1:
            weight = 1 + weight
        counts = name.endswith("num_batches_tracked")
        weights[name] = torch.tensor(0) if counts else torch.tensor(weight, dtype=torch.float32)
    return weights


def write_checkpoint(
    folder: Path, preset: str, weights: Mapping[str, Tensor] | None = None, **more: object
) -> Path:
    """Write a checkpoint as the authors' scripts do; of seeded weights where none are given."""
    chosen = PRESETS[preset]
    if weights is None:
        own = chosen.network().state_dict()
        weights = seeded_weights({name: tuple(weight.shape) for name, weight in own.items()})
    content: object = dict(weights)
    for key in reversed(chosen.place):
        content = {key: content, **more}
    path = folder / f"{preset}.bin"
    torch.save(content, path)
    return path
