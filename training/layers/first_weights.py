"""Initial weights with which layers quickly learn the timing of events.

Linear layers can start from the principal components of their input. Attention, with waves as
positions, can start from neighbours in time.
"""

import math
from typing import Final, NamedTuple

import torch
from torch import Tensor, nn

_LEAST_SPREAD: Final = 1e-3
"""Smallest spread of a principal component or an input; smaller ones are rounding errors."""

_SHARPNESS: Final = 3.0
"""Scale of the weights that attend to nearby times."""


class Components(NamedTuple):
    """Principal components: the mean (values,), directions (values, count), spreads (count,)."""

    mean: Tensor
    directions: Tensor
    spread: Tensor


def principal_components(rows: Tensor, limit: int) -> Components:
    """Return the `limit` largest principal components of `rows` (n, values)."""
    mean = rows.mean(dim=0)
    directions = torch.pca_lowrank(rows, q=min(limit, *rows.shape), niter=4)[2]
    spread = ((rows - mean) @ directions).std(dim=0).clamp_min(_LEAST_SPREAD)
    return Components(mean, directions, spread)


@torch.no_grad()
def standardise_inputs(layer: nn.Module, values: Tensor) -> None:
    """Scale a new linear layer's inputs to equal spread, estimated from `values` (n, in)."""
    weight, bias = layer.get_parameter("weight"), layer.get_parameter("bias")
    weight.div_(values.std(dim=0).clamp_min(_LEAST_SPREAD))
    bias.sub_(weight @ values.mean(dim=0))


def encode_components(
    layer: nn.Linear | nn.Conv2d, components: Components, size: float = 1.0, *, only: bool = False
) -> None:
    """Make a layer's first channels the components, scaled to equal size; zero others if `only`."""
    for weight in layer.parameters() if only else ():
        weight.zero_()
    rows = size * (components.directions / components.spread).T
    layer.weight[: len(rows)] = rows.view(len(rows), *layer.weight.shape[1:])
    if layer.bias is not None:
        layer.bias[: len(rows)] = -layer.weight[: len(rows)].flatten(1) @ components.mean


def decode_components(layer: nn.Linear, components: Components) -> None:
    """Make a layer compute values from their components in its first channels."""
    layer.weight.zero_()
    layer.weight[:, : len(components.spread)] = components.directions * components.spread
    layer.bias.copy_(components.mean)


def waves(places: Tensor, slowest: float, fastest: float, width: int) -> Tensor:
    """Return sines and cosines (places, width) of `places`; frequencies in radians per place."""
    frequencies = torch.logspace(math.log10(slowest), math.log10(fastest), width // 2)
    angles = places[:, None] * frequencies
    return torch.cat([angles.sin(), angles.cos()], dim=1)


def attend_nearby(attention: nn.MultiheadAttention, first: int) -> None:
    """Make each head compare its own mixture of the waves, which start at channel `first`."""
    width, size = attention.embed_dim, attention.head_dim
    for head in range(attention.num_heads):
        compared = torch.linalg.qr(torch.randn(width - first, width - first)).Q[:size]
        for part in (0, width):
            rows = slice(part + head * size, part + head * size + len(compared))
            attention.in_proj_weight[rows] *= 0.3
            attention.in_proj_weight[rows, first:] = _SHARPNESS * compared
