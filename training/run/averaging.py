"""A running mean of the weights, which generates better than the weights of any one step.

An exponential mean (Polyak & Juditsky 1992), as diffusion models use it. It starts as the weights
after the first step, and follows fast at first: where the weights of `n` steps are in the mean, it
keeps ``min(decay, (1 + n) / (10 + n))`` of itself, so that a decay of 0.999 is reached after some
9,000 steps.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Generic

import torch
from torch import Tensor
from torch.optim.swa_utils import AveragedModel

from training.run.batch_statistics import batch_normed
from training.run.task import Network


class AveragedWeights(Generic[Network]):
    """The mean of a network's weights over the steps.

    Its batch statistics are its own: whoever follows shows it the examples of each step.

    Parameters
    ----------
    network : Module
        Whose weights are followed; it is copied.
    decay : float
        The share that the mean keeps in the long run, in (0, 1).
    """

    def __init__(self, network: Network, decay: float) -> None:
        self._decay = decay
        self._model = AveragedModel(network, multi_avg_fn=self._move)

    @property
    def network(self) -> Network:
        """A network of the mean weights."""
        network: Network = self._model.module  # type: ignore[assignment]
        return network

    def follow(self, network: Network) -> None:
        """Take the weights after one more step into the mean."""
        own = [buffer for layer in batch_normed(self.network) for buffer in layer.buffers()]
        before = [buffer.clone() for buffer in own]
        # It copies all buffers, batch statistics among them.
        self._model.update_parameters(network)
        for buffer, kept in zip(own, before, strict=True):
            buffer.copy_(kept)

    def state(self) -> dict[str, Tensor]:
        """Return the mean, and how many steps it holds."""
        return self._model.state_dict()

    def restore(self, state: Mapping[str, Tensor]) -> None:
        """Go on from what `state` returned."""
        self._model.load_state_dict(state)

    def _move(self, mean: Sequence[Tensor], weights: Sequence[Tensor], count: Tensor | int) -> None:
        taken = int(count)
        kept = min(self._decay, (1 + taken) / (10 + taken))
        torch._foreach_lerp_(list(mean), list(weights), 1 - kept)
