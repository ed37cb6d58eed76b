"""A network and its training steps, on any device and number of processes.

The moving average of its weights generates better than the weights of any single step. It is
exponential (Polyak & Juditsky 1992), as in diffusion models, and starts from the weights after the
first step. Its decay after `n` steps is ``min(decay, (1 + n) / (10 + n))``: it follows fast at
first, and reaches a decay of 0.999 after about 9,000 steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Generic

import torch
from torch import Tensor, nn
from torch.amp.autocast_mode import autocast
from torch.nn.modules.batchnorm import _BatchNorm
from torch.optim import Adam, AdamW, Optimizer
from torch.optim.swa_utils import AveragedModel

from motion.arrays import Ints
from motion.errors import InputError
from training.config import Pass, TrainingConfig
from training.run.batches import batches_per_epoch, part_seed, step_parts, step_rows
from training.run.group import Group
from training.run.task import Network, Task

_Part = tuple[int, Ints, float]
"""Number, examples and share of a part of a step."""


class Learner(Generic[Network]):
    """A network that learns.

    Parameters
    ----------
    task : Task
        Network, examples and loss.
    config : TrainingConfig
        The settings.
    group : Group
        The processes that train together; each has a learner, and all learners stay equal.

    Raises
    ------
    InputError
        If a step has fewer examples than processes.
    """

    def __init__(self, task: Task[Network], config: TrainingConfig, group: Group) -> None:
        if min(task.examples, config.batch_size) < group.size:
            raise InputError(
                f"{group.size} processes share steps of "
                f"{min(task.examples, config.batch_size)} examples",
                remedy="Start fewer processes, or make the batch larger",
            )
        self._task = task
        self._config = config
        self._group = group
        self._network = task.network()
        group.hand_out(self._network.state_dict().values())
        self._passes = config.passes or (Pass(name=""),)
        self._pass_weights = _PassWeights(self._network, self._passes)
        self._optimizer = _optimizer(self._network, config)
        decay = config.ema_decay
        self._average = None if decay is None else AveragedWeights(self._network, decay)

    @property
    def network(self) -> Network:
        """The network that is validated and saved: with averaged weights, if configured."""
        return self._network if self._average is None else self._average.network

    def learning_rates(self, step: int) -> dict[str, float]:
        """Return the learning rates of a step, counted from 0, by their names in the log."""
        return {
            f"learning_rate_{p.name}" if p.name else "learning_rate": self._rate(step, p)
            for _, p in self._passes_of(step)
        }

    def learn(self, step: int) -> dict[str, float]:
        """Make a step, counted from 0, and return its losses over all processes.

        If there are several passes, each pass' loss is under its name; ``loss`` is the first one's.
        """
        self._pass_weights.prepare(self._network, step)
        losses: dict[str, float] = {}
        for number, p in self._passes_of(step):
            update_losses = self._update(step, number, p)
            if p.name:
                loss = update_losses.pop("loss")
                update_losses = {"loss": loss, p.name: loss} | update_losses
            losses = update_losses | losses
        if self._average is not None:
            self._average.follow(self._network)
            average = self._average.network
            self._pass_weights.prepare(average, step)
            for number, p in self._passes_of(step) if _statistics(average) else ():
                for part, rows, _ in self._own_parts(step):
                    with torch.no_grad():
                        self._losses(average, rows, p, (step, part, number))
            self._group.hand_out(_statistics(average))
        self._group.hand_out(_statistics(self._network))
        return losses

    def _passes_of(self, step: int) -> list[tuple[int, Pass]]:
        """Return the passes of a step, with their indices."""
        return [(number, p) for number, p in enumerate(self._passes) if p.in_stage(step)]

    def _rate(self, step: int, p: Pass) -> float:
        config = self._config
        rate = p.learning_rate or config.learning_rate
        if config.decay is None:
            return rate
        epoch = step // batches_per_epoch(self._task.examples, config.batch_size)
        return rate * config.decay(epoch)

    def _update(self, step: int, number: int, p: Pass) -> dict[str, float]:
        """Update the weights of a pass, and return its losses over all processes."""
        config = self._config
        for settings in self._optimizer.param_groups:
            settings["lr"] = self._rate(step, p)
        # Weights without a gradient stay unchanged, and so does their state in the optimizer.
        self._optimizer.zero_grad(set_to_none=True)
        with self._pass_weights.learning_only(self._network, p.name):
            losses = self._gradients(step, number, p)
        if config.gradient_clip is not None:
            nn.utils.clip_grad_norm_(self._network.parameters(), config.gradient_clip)
        self._optimizer.step()
        return losses

    def _gradients(self, step: int, number: int, p: Pass) -> dict[str, float]:
        """Compute the gradients of a pass, and return its losses."""
        group = self._group
        sums: dict[str, float] = {}
        for part, rows, share in self._own_parts(step):
            losses = self._losses(self._network, rows, p, (step, part, number))
            torch.autograd.backward(losses["loss"] * share)
            for name, loss in losses.items():
                sums[name] = sums.get(name, 0.0) + share * float(loss.detach())
        group.sum_gradients(self._network.parameters())
        return group.sum(sums)

    def _own_parts(self, step: int) -> list[_Part]:
        """Return the parts of a step that this process computes."""
        config, group = self._config, self._group
        rows = step_rows(step, self._task.examples, config.batch_size, config.seed)
        parts = step_parts(rows, config.accumulate, group.size)
        return [
            (number, parts[number], len(parts[number]) / len(rows))
            for number in range(group.index, len(parts), group.size)
        ]

    def _losses(
        self, network: Network, rows: Ints, p: Pass, place: tuple[int, int, int]
    ) -> Mapping[str, Tensor]:
        """Return the losses of a part of a pass, seeded by its position."""
        reduced = self._config.precision != "float32"
        dtype = getattr(torch, self._config.precision) if reduced else None
        torch.manual_seed(part_seed(self._config.seed, *place))
        with autocast(self._task.device, dtype=dtype, enabled=reduced):
            return self._task.losses(network, rows, p.name)

    def tensors(self) -> dict[str, Tensor]:
        """Return everything that later steps depend on."""
        tensors = {f"network.{name}": value for name, value in self._network.state_dict().items()}
        for index, state in self._optimizer.state_dict()["state"].items():
            tensors |= {f"optimizer.{index}.{name}": value for name, value in state.items()}
        if self._average is not None:
            tensors |= {
                f"average.{name}": value for name, value in self._average.state_dict().items()
            }
        return tensors

    def restore(self, tensors: Mapping[str, Mapping[str, Tensor]]) -> None:
        """Restore the state from the result of `tensors`, grouped by prefix."""
        self._network.load_state_dict(tensors["network"])
        states: dict[int, dict[str, Tensor]] = {}
        for name, tensor in tensors["optimizer"].items():
            index, _, key = name.partition(".")
            states.setdefault(int(index), {})[key] = tensor
        groups = self._optimizer.state_dict()["param_groups"]
        self._optimizer.load_state_dict({"state": states, "param_groups": groups})
        if self._average is not None:
            self._average.load_state_dict(tensors["average"])


class _PassWeights:
    """The weights of a network that learn in each pass.

    Weights that require no gradient from the beginning never learn.
    """

    def __init__(self, network: nn.Module, passes: Sequence[Pass]) -> None:
        self._passes = passes
        self._learning = {name for name, w in network.named_parameters() if w.requires_grad}
        self._by_pass = {p.name: self._learning & _weights(network, p) for p in passes}
        self._by_module = {
            prefix: {name for name, _ in module.named_parameters(prefix)}
            for prefix, module in network.named_modules()
        }

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
        """Require gradients of one pass' weights only."""
        weights: Mapping[str, nn.Parameter] = dict(network.named_parameters())
        try:
            for key in self._learning:
                weights[key].requires_grad_(key in self._by_pass[name])
            yield
        finally:
            for key in self._learning:
                weights[key].requires_grad_(True)


def _statistics(network: nn.Module) -> list[Tensor]:
    """Return the running statistics of all batch normalisation layers."""
    layers = (layer for layer in network.modules() if isinstance(layer, _BatchNorm))
    return [buffer for layer in layers for buffer in layer.buffers()]


def _weights(network: nn.Module, p: Pass) -> set[str]:
    """Return the names of the weights in the parts of a pass."""
    starts = tuple(f"{part}." for part in p.parts)
    return {
        name
        for name, _ in network.named_parameters()
        if not starts or f"{name}.".startswith(starts)
    }


def _optimizer(network: nn.Module, config: TrainingConfig) -> Optimizer:
    kind: type[Adam | AdamW] = {"adam": Adam, "adamw": AdamW}[config.optimizer]
    return kind(
        network.parameters(),
        lr=config.learning_rate,
        betas=config.betas,
        weight_decay=config.weight_decay,
    )


class AveragedWeights(AveragedModel, Generic[Network]):
    """The moving average of a network's weights over the steps.

    It has its own batch statistics, which the caller updates with the examples of each step.

    Parameters
    ----------
    network : Module
        The network whose weights are averaged; it is copied.
    decay : float
        Decay of the average in the long run, in (0, 1).
    """

    def __init__(self, network: Network, decay: float) -> None:
        super().__init__(network, multi_avg_fn=self._move)
        self._decay = decay

    @property
    def network(self) -> Network:
        """A network with the averaged weights."""
        network: Network = self.module  # type: ignore[assignment]
        return network

    def follow(self, network: Network) -> None:
        """Update the average with the weights after one more step."""
        statistics = _statistics(self.network)
        saved = [buffer.clone() for buffer in statistics]
        # This copies all buffers, including batch statistics.
        self.update_parameters(network)
        for buffer, value in zip(statistics, saved, strict=True):
            buffer.copy_(value)

    def _move(self, mean: Sequence[Tensor], weights: Sequence[Tensor], count: Tensor | int) -> None:
        steps = int(count)
        decay = min(self._decay, (1 + steps) / (10 + steps))
        torch._foreach_lerp_(list(mean), list(weights), 1 - decay)
