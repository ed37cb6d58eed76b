"""What the loop needs to know of a network, its examples and its loss."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray
from torch import Tensor, nn

Network = TypeVar("Network", bound=nn.Module)


class Task(Protocol[Network]):
    """Something to be learned."""

    @property
    def settings(self) -> Mapping[str, Any]:
        """What makes this task another one than the next, as JSON values: kind, sizes, labels."""
        ...

    @property
    def data_sha256(self) -> str:
        """Hash of all examples, held-out ones included."""
        ...

    @property
    def examples(self) -> int:
        """How many examples there are to learn from, without the held-out ones."""
        ...

    @property
    def device(self) -> str:
        """Where it is computed: ``cpu`` or ``cuda``."""
        ...

    def network(self) -> Network:
        """Return a fresh network on the device; its first weights come from torch's generator."""
        ...

    def losses(self, network: Network, rows: NDArray[np.int64]) -> Mapping[str, Tensor]:
        """Return the losses of a batch of examples: ``loss``, which is minimised, and its parts.

        Each is a mean over the examples, so that a batch may be computed in parts, by one process
        or several. Chance comes from torch's generator alone: it is seeded anew for every part of
        every step.
        """
        ...

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return what is measured of held-out examples, first what the weights are chosen by.

        Of the first, which any name may have, less is better: the weights of the step where it was
        least are kept. It should be what the network is for, which the sum of all losses need not
        be, and be measured on enough examples to tell steps apart.
        The network is in evaluation mode, and no gradients are kept. torch's generator is seeded
        alike each time, so that what is drawn here is the same noise at every step.
        """
        ...


class TaskInPasses(Task[Network], Protocol[Network]):
    """Something that is learned in several passes; see `training.run.passes.Pass`."""

    def losses_of(
        self, name: str, network: Network, rows: NDArray[np.int64]
    ) -> Mapping[str, Tensor]:
        """Return the losses of a batch for the pass of that name, as `losses` does for all.

        Weights that do not learn in the pass need no gradient while it is asked.
        """
        ...
