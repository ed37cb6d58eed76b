"""The batches of a training: the examples of each step, and their statistics.

Examples and randomness are a function of the seed and the step, so nothing needs to be saved to
resume from any step.

One or several processes may compute a step in parts. A layer that normalises by the mean and
variance of a batch needs those of the whole step. They are computed first, by forward passes of the
parts until the statistics no longer change: a layer's statistics depend on those of the layers
before it. Then the losses are computed with the statistics as constants that collect gradients.
These gradients are propagated back through the statistics until none is left. The result equals
that of the step in one part, up to rounding, at the cost of a few extra passes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn.modules.batchnorm import _BatchNorm

from training.run.group import Group

Compute = Callable[[], object]
"""A forward pass of one part, with the same random numbers each time."""

_Use = tuple[int, int]
"""Index of a layer, and of its use in a pass, from 0."""


class _AllLayersPassed(Exception):  # noqa: N818 (no error)
    """The forward pass has reached the last layer."""


def batch_normed(network: nn.Module) -> list[_BatchNorm]:
    """Return the batch normalisation layers of `network`."""
    return [layer for layer in network.modules() if isinstance(layer, _BatchNorm)]


class StepStatistics:
    """The statistics of one step for all batch normalisation layers of a network.

    Parameters
    ----------
    network : Module
        The network; only its layers in training mode count.
    group : Group
        The processes that compute the step.
    parts : sequence of callable
        Forward passes of this process' parts.
    """

    def __init__(self, network: nn.Module, group: Group, parts: Sequence[Compute]) -> None:
        self._layers = [layer for layer in batch_normed(network) if layer.training]
        self._group = group
        self._parts = parts
        self._moments: dict[_Use, Tensor] = {}
        self._counts: dict[_Use, Tensor] = {}
        self._find()

    @contextmanager
    def applied(self) -> Iterator[None]:
        """Make the layers normalise by the step's statistics, which collect gradients."""
        with self._replaced(lambda place, layer, values: None):
            yield

    def pass_back(self) -> None:
        """Add the gradients that reach the weights through the statistics."""
        for _ in self._moments:
            owed_gradients = self._summed(
                {
                    place: torch.zeros_like(m) if m.grad is None else m.grad
                    for place, m in self._moments.items()
                }
            )
            for m in self._moments.values():
                m.grad = None
            if not any(bool(m.any()) for m in owed_gradients.values()):
                return
            for compute in self._parts:
                contributions: list[Tensor] = []

                def take(place: _Use, layer: _BatchNorm, values: Tensor) -> None:
                    sums = _sums(layer, values)
                    contributions.append((owed_gradients[place] * sums).sum() / self._counts[place])  # noqa: B023

                self._pass(compute, take)
                contribution = torch.stack(contributions).sum()
                if contribution.requires_grad:
                    torch.autograd.backward(contribution)

    def remember(self) -> None:
        """Update the layers' running statistics with this step."""
        statistics = {
            place: _mean_and_variance(self._layers[place[0]], m.detach())
            for place, m in self._moments.items()
        }
        for place, (mean, variance) in statistics.items():
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
            sums: dict[_Use, Tensor] = {}
            counts: dict[_Use, Tensor] = {}

            def take(place: _Use, layer: _BatchNorm, values: Tensor) -> None:
                layer_sums = _sums(layer, values)
                count = layer_sums.new_tensor([values.numel() / values.shape[1]])
                sums[place] = sums.get(place, 0) + layer_sums  # noqa: B023
                counts[place] = counts.get(place, 0) + count  # noqa: B023

            with torch.no_grad():
                for compute in self._parts:
                    self._pass(compute, take)
            self._counts = self._summed(counts)
            before = self._moments
            self._moments = {
                place: (m / self._counts[place]).requires_grad_()
                for place, m in self._summed(sums).items()
            }
            if before and all(m.equal(before[place]) for place, m in self._moments.items()):
                return
            passes += 1

    def _pass(self, compute: Compute, take: Callable[[_Use, _BatchNorm, Tensor], None]) -> None:
        """Pass a part forward as far as the last layer, and call `take` with each layer's input."""
        remaining = len(self._moments)

        def look(place: _Use, layer: _BatchNorm, values: Tensor) -> None:
            nonlocal remaining
            take(place, layer, values)
            remaining -= 1
            if remaining == 0:
                raise _AllLayersPassed

        with self._replaced(look):
            try:
                compute()
            except _AllLayersPassed:
                return

    @contextmanager
    def _replaced(self, look: Callable[[_Use, _BatchNorm, Tensor], None]) -> Iterator[None]:
        """Make the layers pass their inputs to `look`, and normalise by the known statistics."""
        uses: dict[int, int] = {}

        def forward(number: int, values: Tensor) -> Tensor:
            layer = self._layers[number]
            place = (number, uses.get(number, 0))
            uses[number] = place[1] + 1
            look(place, layer, values)
            m = self._moments.get(place)
            if m is None:
                m = _sums(layer, values) * values.shape[1] / values.numel()
            mean, variance = (s.view(_shape(values)) for s in _mean_and_variance(layer, m))
            out = (values.float() - mean) * (variance + layer.eps).rsqrt()
            if layer.affine:
                out = out * layer.weight.view(_shape(values)) + layer.bias.view(_shape(values))
            return out.to(values.dtype)

        for number, layer in enumerate(self._layers):
            layer.forward = partial(forward, number)  # type: ignore[method-assign]
        try:
            yield
        finally:
            for layer in self._layers:
                del layer.forward

    def _summed(self, local: dict[_Use, Tensor]) -> dict[_Use, Tensor]:
        return dict(zip(local, self._group.sum_tensors(list(local.values())), strict=True))


def _mean_and_variance(layer: _BatchNorm, m: Tensor) -> tuple[Tensor, Tensor]:
    """Return mean and variance of each channel, from the moments `m` about the layer's shift."""
    first, second = m
    return _shift(layer, first) + first, second - first.square()


def _sums(layer: _BatchNorm, values: Tensor) -> Tensor:
    """Return each channel's sums of shifted values and of their squares, shape (2, channels)."""
    centred = values.float()
    centred = centred - _shift(layer, centred).view(_shape(values))
    dimensions = [0, *range(2, centred.dim())]
    return torch.stack([centred.sum(dimensions), centred.square().sum(dimensions)])


def _shift(layer: _BatchNorm, reference: Tensor) -> Tensor:
    """Return the offset that is subtracted from values before summing, to reduce rounding."""
    if layer.running_mean is None:
        return reference.new_zeros(layer.num_features)
    return layer.running_mean.detach()


def _shape(values: Tensor) -> tuple[int, ...]:
    return (1, -1, *[1] * (values.dim() - 2))


def batches_per_epoch(examples: int, batch_size: int) -> int:
    """Return the number of whole batches of `examples`, at least one."""
    return max(1, examples // batch_size)


def step_rows(step: int, examples: int, batch_size: int, seed: int) -> NDArray[np.int64]:
    """Return the examples of a step.

    Parameters
    ----------
    step : int
        Number of the step, from 0.
    examples, batch_size : int
        Numbers of examples in all and per step, at least 1.
    seed : int
        Random seed, at least 0.

    Returns
    -------
    ndarray, shape (min(batch_size, examples),), int64
        Indices of the examples. Each epoch goes through all examples in a new order; an incomplete
        last batch is dropped.
    """
    epoch, place = divmod(step, batches_per_epoch(examples, batch_size))
    order = np.random.default_rng((seed, epoch)).permutation(examples)
    return order[place * batch_size : (place + 1) * batch_size]


def step_parts(
    rows: NDArray[np.int64], accumulate: int, processes: int
) -> Sequence[NDArray[np.int64]]:
    """Divide a step's examples into the parts that the processes compute.

    Each process computes equally many parts. One process with `n` parts and `n` processes with one
    part each compute the same parts.

    Parameters
    ----------
    rows : ndarray, shape (n,), int64
        Examples of a step, at least as many as processes.
    accumulate : int
        Number of parts, at least 1.
    processes : int
        Number of processes, at least 1.

    Returns
    -------
    sequence of ndarray
        Their number is the smallest multiple of `processes` that is at least `accumulate`, or less
        if there are too few examples. Their lengths differ by at most one.
    """
    shares = min(-(-accumulate // processes), len(rows) // processes)
    return np.array_split(rows, shares * processes)


def part_seed(seed: int, step: int, part: int, update: int = 0) -> int:
    """Return the random seed of a part of a step, from 0 to 2**63 - 1.

    Each of the updates in a step, numbered from 0, has its own seeds.
    """
    entropy = (seed, step, part, *((update,) if update else ()))
    state = np.random.SeedSequence(entropy).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))


def evenly_spaced(count: int, limit: int) -> NDArray[np.int64]:
    """Return at most `limit` of `count` indices, including the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, limit)).round().astype(np.int64))
