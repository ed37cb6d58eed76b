"""Linear maps of few frames, whose weights lie in memory as their products read them.

A map keeps its weights output by output. A product with a few dozen frames reads them input by
input, and spends part of its time on putting them into that order.
"""

from __future__ import annotations

from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

_APART: Final = 64
"""Values between the weights of one input and of the next: a power of two would crowd the cache."""


class PreparedLinear:
    """Maps as `torch.nn.Linear` does, but for rounding, in less time.

    Parameters
    ----------
    weight : Tensor
        (outputs, inputs), copied.
    bias : Tensor
        (outputs,).
    """

    def __init__(self, weight: Tensor, bias: Tensor) -> None:
        self._weight, self._bias = input_by_input(weight), bias

    def mapped(self, features: Tensor) -> Tensor:
        """Return (…, outputs) of `features`, (…, inputs)."""
        return functional.linear(features, self._weight, self._bias)


def input_by_input(weight: Tensor) -> Tensor:
    """Return a copy of `weight`, (outputs, inputs), that lies in memory input by input."""
    outputs, inputs = weight.shape
    room = torch.empty(inputs, outputs + _APART, dtype=weight.dtype, device=weight.device)
    return room[:, :outputs].copy_(weight.t()).t()
