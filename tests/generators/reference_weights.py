"""Weights drawn by their names, with which networks computed the reference outputs."""

import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest
import torch
from torch import Tensor

REFERENCE = Path(__file__).parents[3] / "shared" / "reference"

PIECE = 1 << 16
"""Numbers drawn at once: so few fit into the processor's cache, which is several times faster."""


def reference_arrays(name: str) -> dict[str, Tensor]:
    """Return what a released network was given and what it answered; skip where it is not here."""
    if not (REFERENCE / f"{name}.npz").exists():
        pytest.skip("the reference of the released network is not here")
    with np.load(REFERENCE / f"{name}.npz") as arrays:
        return {key: torch.from_numpy(np.asarray(arrays[key])) for key in arrays}


def reference_weights(shapes: Mapping[str, Sequence[int]]) -> dict[str, Tensor]:
    """Return weights of these shapes, each drawn by its name."""
    return {name: _weight(name, shape) for name, shape in shapes.items()}


def _weight(name: str, shape: Sequence[int]) -> Tensor:
    if name.endswith("num_batches_tracked"):
        return torch.tensor(0)
    random = np.random.default_rng(zlib.crc32(name.encode()))
    weight = torch.empty(tuple(shape))
    flat = weight.view(-1).numpy()
    for start in range(0, len(flat), PIECE):
        piece = flat[start : start + PIECE]
        drawn = 0.05 * random.standard_normal(len(piece))
        if name.endswith("running_var"):
            drawn = 1 + np.abs(drawn)
        elif name.endswith(".weight") and len(shape) == 1:
            drawn = 1 + drawn
        piece[:] = drawn
    return weight
