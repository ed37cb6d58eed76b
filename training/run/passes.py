"""Several updates in a step, each of some weights by a loss of its own, and training in stages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

from torch import nn

from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Pass:
    """An update of some weights by one loss.

    Passes of a step are made one after the other: the second one uses the weights that the first
    one changed. Weights that belong to none of the passes of a stage are frozen in it.

    Attributes
    ----------
    name : str
        Its name for the task and in the log.
    parts : tuple of str
        Names of the network's modules or weights that learn, as in ``named_modules``; all of it
        where there are none.
    learning_rate : float or None
        None for the training's. It decays as the training's does.
    every : int
        Its interval in steps, counted from `first`.
    first : int
        The step at which it starts, from 0.
    end : int or None
        The step at which it ends.
    """

    name: str
    parts: tuple[str, ...] = ()
    learning_rate: float | None = None
    every: int = 1
    first: int = 0
    end: int | None = None

    def in_stage(self, step: int) -> bool:
        """Return whether a step, counted from 0, belongs to the pass' stage."""
        return self.first <= step and (self.end is None or step < self.end)

    def is_due(self, step: int) -> bool:
        """Tell whether the pass is made in a step, from 0."""
        return self.in_stage(step) and (step - self.first) % self.every == 0


class PassWeights:
    """The weights of a network that learn in each pass.

    Parameters
    ----------
    network : Module
        Weights that need no gradient from the beginning never learn.
    passes : sequence of Pass
        With distinct names.
    steps : int
        Of the whole training.

    Raises
    ------
    InputError
        If the network has no such part, or no pass is made in some step.
    """

    def __init__(self, network: nn.Module, passes: Sequence[Pass], steps: int) -> None:
        self._passes = passes
        self._learning = {name for name, w in network.named_parameters() if w.requires_grad}
        self._by_pass = {p.name: self._learning & _weights(network, p) for p in passes}
        self._by_module = {
            prefix: {f"{prefix}.{name}".strip(".") for name, _ in module.named_parameters()}
            for prefix, module in network.named_modules()
        }
        idle = next(
            (step for step in range(steps) if not any(p.is_due(step) for p in passes)), None
        )
        if idle is not None:
            raise InputError(
                f"no pass is made in step {idle + 1} of {steps}",
                remedy="Let one be made in every step",
            )

    def prepare(self, network: nn.Module, step: int) -> None:
        """Put a network into training mode, except for parts frozen in the step's stage."""
        network.train()
        learning = set().union(*(self._by_pass[p.name] for p in self._passes if p.in_stage(step)))
        for prefix, module in network.named_modules():
            weights = self._by_module[prefix]
            if weights and weights.isdisjoint(learning):
                module.eval()

    @contextmanager
    def learning_only(self, network: nn.Module, name: str) -> Iterator[None]:
        """Let only the weights of one pass gather gradients."""
        weights: Mapping[str, nn.Parameter] = dict(network.named_parameters())
        try:
            for key in self._learning:
                weights[key].requires_grad_(key in self._by_pass[name])
            yield
        finally:
            for key in self._learning:
                weights[key].requires_grad_(True)


def _weights(network: nn.Module, p: Pass) -> set[str]:
    """Return the names of the weights in the parts of a pass."""
    names = [name for name, _ in network.named_parameters()]
    for part in p.parts:
        if not any(f"{name}.".startswith(f"{part}.") for name in names):
            children = ", ".join(name for name, _ in network.named_children())
            raise InputError(
                f"the pass {p.name!r} trains {part!r}, which has no weights in the network",
                remedy=f"Name one of its parts: {children}",
            )
    if not p.parts:
        return set(names)
    return {name for name in names if any(f"{name}.".startswith(f"{part}.") for part in p.parts)}
