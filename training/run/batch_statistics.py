"""Batch statistics of a step that is computed in parts, by one process or several.

A layer that normalises by the mean and variance of a batch has to see those of the whole step,
whoever computes which part of it. So they are found first, by passing the parts forward until they
no longer change: a layer's statistics follow from those of the layers before it. Then the losses
are computed with the statistics held, as constants of which gradients are taken; and these
gradients are passed back through the statistics, again until none is left. What comes out is the
step in one part, up to rounding, at the price of a few passes more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

import torch
from torch import Tensor, nn
from torch.nn.modules.batchnorm import _BatchNorm

from training.run.group import Group

Compute = Callable[[], object]
"""Passes one part forward, with the same chance each time."""

_Place = tuple[int, int]
"""Which layer, and which of its uses in a pass, from 0."""


class _Enough(Exception):  # noqa: N818 (no error)
    """All layers have been passed."""


def batch_normed(network: nn.Module) -> list[_BatchNorm]:
    """Return the layers of `network` that normalise by statistics of a batch."""
    return [layer for layer in network.modules() if isinstance(layer, _BatchNorm)]


class StepStatistics:
    """The statistics of one step for all layers of a network that normalise by them.

    Parameters
    ----------
    network : Module
        In training mode; only its layers that are so, too, are looked at.
    group : Group
        The processes that compute the step.
    parts : sequence of callable
        Each passes one of this process' parts forward through the network.
    """

    def __init__(self, network: nn.Module, group: Group, parts: Sequence[Compute]) -> None:
        self._layers = [layer for layer in batch_normed(network) if layer.training]
        self._group = group
        self._parts = parts
        self._moments: dict[_Place, Tensor] = {}
        self._counts: dict[_Place, Tensor] = {}
        self._find()

    @contextmanager
    def held(self) -> Iterator[None]:
        """Let the layers normalise one part by the statistics of the step, and owe to these."""
        with self._instead(lambda place, layer, values: None):
            yield

    def pass_back(self) -> None:
        """Add to the weights' gradients what the losses owe to the statistics."""
        for _ in self._moments:
            owed = self._summed(
                {
                    place: torch.zeros_like(one) if one.grad is None else one.grad
                    for place, one in self._moments.items()
                }
            )
            for one in self._moments.values():
                one.grad = None
            if not any(bool(one.any()) for one in owed.values()):
                return
            for compute in self._parts:
                dues: list[Tensor] = []

                def take(place: _Place, layer: _BatchNorm, values: Tensor) -> None:
                    sums = _sums(layer, values)
                    dues.append((owed[place] * sums).sum() / self._counts[place])  # noqa: B023

                self._pass(compute, take)
                due = torch.stack(dues).sum()
                if due.requires_grad:
                    torch.autograd.backward(due)

    def remember(self) -> None:
        """Take the step into the layers' running statistics."""
        found = {
            place: _normal(self._layers[place[0]], one.detach())
            for place, one in self._moments.items()
        }
        for place, (mean, variance) in found.items():
            layer, count = self._layers[place[0]], self._counts[place]
            steps = layer.num_batches_tracked
            if layer.running_mean is None or layer.running_var is None or steps is None:
                continue
            steps.add_(1)
            share = 1 / float(steps) if layer.momentum is None else layer.momentum
            layer.running_mean.lerp_(mean, share)
            layer.running_var.lerp_(variance * count / (count - 1).clamp(min=1), share)

    def _find(self) -> None:
        passes = 1
        while passes <= max(1, len(self._moments)):
            sums: dict[_Place, Tensor] = {}
            counts: dict[_Place, Tensor] = {}

            def take(place: _Place, layer: _BatchNorm, values: Tensor) -> None:
                found = _sums(layer, values)
                count = found.new_tensor([values.numel() / values.shape[1]])
                sums[place] = sums.get(place, 0) + found  # noqa: B023
                counts[place] = counts.get(place, 0) + count  # noqa: B023

            with torch.no_grad():
                for compute in self._parts:
                    self._pass(compute, take)
            self._counts = self._summed(counts)
            before = self._moments
            self._moments = {
                place: (one / self._counts[place]).requires_grad_()
                for place, one in self._summed(sums).items()
            }
            if before and all(one.equal(before[place]) for place, one in self._moments.items()):
                return
            passes += 1

    def _pass(self, compute: Compute, take: Callable[[_Place, _BatchNorm, Tensor], None]) -> None:
        """Pass a part forward as far as the last layer, and show `take` what each is given."""
        left = len(self._moments)

        def look(place: _Place, layer: _BatchNorm, values: Tensor) -> None:
            nonlocal left
            take(place, layer, values)
            left -= 1
            if left == 0:
                raise _Enough

        with self._instead(look):
            try:
                compute()
            except _Enough:
                return

    @contextmanager
    def _instead(self, look: Callable[[_Place, _BatchNorm, Tensor], None]) -> Iterator[None]:
        """Let the layers show `look` what they are given, and normalise by what is known."""
        uses: dict[int, int] = {}

        def forward(number: int, values: Tensor) -> Tensor:
            layer = self._layers[number]
            place = (number, uses.get(number, 0))
            uses[number] = place[1] + 1
            look(place, layer, values)
            moments = self._moments.get(place)
            if moments is None:
                moments = _sums(layer, values) * values.shape[1] / values.numel()
            mean, variance = (one.view(_shape(values)) for one in _normal(layer, moments))
            found = (values.float() - mean) * (variance + layer.eps).rsqrt()
            if layer.affine:
                found = found * layer.weight.view(_shape(values)) + layer.bias.view(_shape(values))
            return found.to(values.dtype)

        for number, layer in enumerate(self._layers):
            layer.forward = partial(forward, number)  # type: ignore[method-assign]
        try:
            yield
        finally:
            for layer in self._layers:
                del layer.forward

    def _summed(self, here: dict[_Place, Tensor]) -> dict[_Place, Tensor]:
        return dict(zip(here, self._group.sum_tensors(list(here.values())), strict=True))


def _normal(layer: _BatchNorm, moments: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and variance by channel, of the first two moments about the layer's shift."""
    first, second = moments
    return _shift(layer, first) + first, second - first.square()


def _sums(layer: _BatchNorm, values: Tensor) -> Tensor:
    """Return the sums of values and of their squares by channel, shape (2, channels)."""
    own = values.float()
    own = own - _shift(layer, own).view(_shape(values))
    dimensions = [0, *range(2, own.dim())]
    return torch.stack([own.sum(dimensions), own.square().sum(dimensions)])


def _shift(layer: _BatchNorm, like: Tensor) -> Tensor:
    """Return what is taken off values before they are summed, so that rounding stays small."""
    if layer.running_mean is None:
        return like.new_zeros(layer.num_features)
    return layer.running_mean.detach()


def _shape(values: Tensor) -> tuple[int, ...]:
    return (1, -1, *[1] * (values.dim() - 2))
