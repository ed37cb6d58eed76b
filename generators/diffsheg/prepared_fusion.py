"""A fusion that reads what it is told beforehand, and the motion's features when they come.

The plain `generators.diffsheg.layers.Fusion` normalises features and conditions together and maps
them on. Taken apart, with m the mean and r the inverse deviation of all values together, and with
the norm's own scale and shift worked into the weights W and the bias b::

    W · norm([features, conditions]) + b
        = r · (W_f · features + W_c · conditions − m · sum of W's columns) + b

so that W_c · conditions is computed once, however often features come.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from generators.diffsheg.layers import Fusion
from generators.diffsheg.prepared_linear import PreparedLinear, input_by_input


@dataclass(frozen=True, eq=False)
class Spread:
    """Mean and inverse deviation of the values of each frame, (…, frames, 1).

    A norm's epsilon is part of the variance.
    """

    mean: Tensor
    inverse: Tensor

    def with_others(self, others: Spread, share: float) -> Spread:
        """Return that of these values and `others` together, of which these are a `share`."""
        gap = self.mean - others.mean
        variance = (1 - share) * others.inverse.pow(-2)
        variance.add_(self.inverse.pow(-2), alpha=share)
        variance.addcmul_(gap, gap, value=share * (1 - share))
        return Spread(torch.add(others.mean, gap, alpha=share), variance.rsqrt_())


def spread(values: Tensor, epsilon: float) -> Spread:
    """Return that of `values`, (…, frames, values)."""
    _, mean, inverse = torch.native_layer_norm(values, values.shape[-1:], None, None, epsilon)
    return Spread(mean, inverse)


def of_conditions(plain: Fusion, width: int) -> Tensor:
    """Return what maps the conditions of a fusion, (inner width, conditions)."""
    return plain.widen.weight[:, width:] * plain.norm.weight[width:]


class PreparedFusion:
    """One fusion with its norm worked into its weights.

    Parameters
    ----------
    plain : Fusion
        In evaluation mode.
    width : int
        Values of features; the rest are conditions.
    """

    def __init__(self, plain: Fusion, width: int) -> None:
        scaled = plain.widen.weight * plain.norm.weight
        self._of_features = input_by_input(scaled[:, :width]).t()
        self._sums = scaled.sum(dim=1)
        self._bias = functional.linear(plain.norm.bias, plain.widen.weight, plain.widen.bias)
        self._narrow = PreparedLinear(plain.narrow.weight, plain.narrow.bias)
        self._share = width / scaled.shape[1]
        self._epsilon = plain.norm.eps

    def change(self, features: Tensor, mapped: Tensor, conditions: Spread) -> None:
        """Tell `features` their conditions, in place.

        Parameters
        ----------
        features : Tensor
            (frames, width).
        mapped : Tensor
            (frames, inner width), the conditions mapped by `of_conditions`.
        conditions : Spread
            Of the conditions.
        """
        both = spread(features, self._epsilon).with_others(conditions, self._share)
        inner = torch.addcmul(mapped, both.mean, self._sums, value=-1)
        inner.addmm_(features, self._of_features)
        inner = torch.addcmul(self._bias, inner, both.inverse)
        features += self._narrow.mapped(functional.silu(inner, inplace=True))
