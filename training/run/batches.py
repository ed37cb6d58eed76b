"""The batches of a training: which examples each step learns from, and their statistics.

Examples and randomness are a function of the seed and the step, so nothing needs to be saved to
resume from any step.

A step may be computed in parts, by one process or several. A layer that normalises by the mean and
variance of a batch needs those of the whole step, whoever computes which part of it. They are
computed first, by passing the parts forward until they no longer change: a layer's statistics
follow from those of the layers before it. Then the losses are computed with the statistics as
constants of which gradients are taken; and these gradients are passed back through the statistics,
again until none is left. The result is that of the step in one part, up to rounding, at the price
of a few extra passes.
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
"""Passes one part forward, with the same chance each time."""

_Use = tuple[int, int]
"""A layer, and the number of its use in a pass, from 0."""


class _AllLayersPassed(Exception):  # noqa: N818 (no error)
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
        self._moments: dict[_Use, Tensor] = {}
        self._counts: dict[_Use, Tensor] = {}
        self._find()

    @contextmanager
    def applied(self) -> Iterator[None]:
        """Let the layers normalise one part by the statistics of the step, and owe to these."""
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
        """Take the step into the layers' running statistics."""
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
        """Pass a part forward as far as the last layer, and show `take` what each is given."""
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
        """Pass the layers' inputs to `look`, and normalise by the known statistics."""
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
    """Return mean and variance by channel, of the first two moments about the layer's shift."""
    first, second = m
    return _shift(layer, first) + first, second - first.square()


def _sums(layer: _BatchNorm, values: Tensor) -> Tensor:
    """Return the sums of values and of their squares by channel, shape (2, channels)."""
    centred = values.float()
    centred = centred - _shift(layer, centred).view(_shape(values))
    dimensions = [0, *range(2, centred.dim())]
    return torch.stack([centred.sum(dimensions), centred.square().sum(dimensions)])


def _shift(layer: _BatchNorm, reference: Tensor) -> Tensor:
    """Return an offset subtracted from values before they are summed, to reduce rounding."""
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
        From 0.
    examples, batch_size : int
        At least 1.
    seed : int
        Not negative.

    Returns
    -------
    ndarray, shape (min(batch_size, examples),), int64
        Each epoch goes through all examples in its own order; what fills no batch at its end is
        left out of it.
    """
    epoch, place = divmod(step, batches_per_epoch(examples, batch_size))
    order = np.random.default_rng((seed, epoch)).permutation(examples)
    return order[place * batch_size : (place + 1) * batch_size]


def step_parts(
    rows: NDArray[np.int64], accumulate: int, processes: int
) -> Sequence[NDArray[np.int64]]:
    """Return the parts in which a step's examples are computed, by all processes together.

    Each process computes equally many parts. One process that makes `n` parts and `n` processes
    that make one each compute the same ones.

    Parameters
    ----------
    rows : ndarray, shape (n,), int64
        Examples of a step, at least as many as processes.
    accumulate : int
        Number of parts, at least 1.
    processes : int
        At least 1.

    Returns
    -------
    sequence of ndarray
        The least multiple of `processes` that is `accumulate` or more, as far as each gets an
        example; their lengths differ by one at most.
    """
    shares = min(-(-accumulate // processes), len(rows) // processes)
    return np.array_split(rows, shares * processes)


def part_seed(seed: int, step: int, part: int, update: int = 0) -> int:
    """Return the random seed of a part of a step, from 0 to 2**63 - 1.

    Each of several updates in a step, numbered from 0, has its own.
    """
    entropy = (seed, step, part, *((update,) if update else ()))
    state = np.random.SeedSequence(entropy).generate_state(1, np.uint64)
    return int(state[0] >> np.uint64(1))


def evenly_spaced(count: int, limit: int) -> NDArray[np.int64]:
    """Return at most this many of `count` examples, including the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(count, limit)).round().astype(np.int64))
