"""Checkpoints of published networks, of seeded weights."""

from collections.abc import Mapping
from pathlib import Path

import torch
from torch import Tensor

from analysis.evaluators.published_presets import PRESETS
from tests.generators.reference_weights import reference_weights


def write_checkpoint(
    folder: Path, preset: str, weights: Mapping[str, Tensor] | None = None, **more: object
) -> Path:
    """Write a checkpoint as the authors' scripts do; of seeded weights where none are given."""
    chosen = PRESETS[preset]
    if weights is None:
        own = chosen.network().state_dict()
        weights = reference_weights({name: tuple(weight.shape) for name, weight in own.items()})
    content: object = dict(weights)
    for key in reversed(chosen.place):
        content = {key: content, **more}
    path = folder / f"{preset}.bin"
    torch.save(content, path)
    return path
