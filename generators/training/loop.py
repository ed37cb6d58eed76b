"""The loop that trains every network."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Generic

import torch
from torch import Tensor, nn
from torch.optim import Adam, AdamW, Optimizer

from generators.training.batch_order import rows_of_step
from generators.training.checkpoint import Best, restore_checkpoint, write_checkpoint
from generators.training.config import TrainingConfig
from generators.training.curves import draw_curves
from generators.training.interruption import stop_request
from generators.training.run_folder import LogLine, RunFolder
from generators.training.task import Network, Task
from generators.training.weights_file import read_weights, write_weights
from motion.errors import InputError

Show = Callable[[int, int, str], None]
"""Told how many steps are done, of how many, and the loss in words."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Trained(Generic[Network]):
    """What came out of a run.

    Attributes
    ----------
    network : Module
        With the weights that did best on held-out examples, in evaluation mode.
    best : Best
        When that was, and what was measured then.
    steps : int
        Steps made in all.
    last_loss : float
        Loss of the last step.
    """

    network: Network
    best: Best
    steps: int
    last_loss: float


class TrainingStopped(KeyboardInterrupt):
    """Somebody asked to stop; the state was saved, and the same call goes on from it.

    Attributes
    ----------
    step, steps : int
        Steps made, and wanted.
    """

    def __init__(self, step: int, steps: int) -> None:
        super().__init__(f"stopped after step {step} of {steps}")
        self.step = step
        self.steps = steps


def train(
    task: Task[Network], config: TrainingConfig, folder: RunFolder, *, show: Show | None = None
) -> Trained[Network]:
    """Train a network, or go on training it where an earlier call stopped.

    However often a run is stopped and continued, weights, log and curves come out the same bytes
    on the processor of one machine with one number of threads; a graphics processor may differ in
    the last digits.

    Parameters
    ----------
    task : Task
        Network, examples and loss.
    config : TrainingConfig
        How.
    folder : RunFolder
        Where the run is kept; made if needed.
    show : callable, optional
        Told about progress.

    Raises
    ------
    InputError
        If the run kept in `folder` is another one, a loss is no number, or the device is missing.
    TrainingStopped
        After Ctrl-C, or a request to end: the state is saved.
    """
    check_device(task.device)
    # Now rather than at the first save: a place that cannot be written costs no training.
    folder.root.mkdir(parents=True, exist_ok=True)
    with torch.random.fork_rng(), _repeatable(task.device):
        torch.manual_seed(config.seed)
        return _Run(task, config, folder, show or (lambda done, total, detail: None)).finish()


class _Run(Generic[Network]):
    """A run under way."""

    def __init__(
        self, task: Task[Network], config: TrainingConfig, folder: RunFolder, show: Show
    ) -> None:
        self._task = task
        self._config = config
        self._folder = folder
        self._show = show
        self._network = task.network()
        self._optimizer = _optimizer(self._network, config)
        self._step = 0
        self._best: Best | None = None
        self._best_weights: dict[str, Tensor] | None = None
        if folder.checkpoint.exists():
            self._step, self._best = restore_checkpoint(
                folder.checkpoint, task, config, self._network, self._optimizer
            )
        self._log: list[LogLine] = folder.read_log(self._step)
        if len(self._log) != self._step:
            raise InputError(
                f"the log tells of {len(self._log)} of the {self._step} steps that were made",
                where=folder.log,
                remedy="Put the log back, or begin anew in another place",
            )

    def finish(self) -> Trained[Network]:
        """Make the steps that are missing."""
        steps = self._config.steps
        began = self._step
        with stop_request() as asked_to_stop:
            while self._step < steps:
                if asked_to_stop:
                    self._save()
                    raise TrainingStopped(self._step, steps)
                self._advance()
                if self._step % self._config.checkpoint_every == 0:
                    self._save()
                self._show(self._step, steps, f"loss {self._log[-1]['loss']:.4g}")
        best = self._best or self._validate()
        if self._step > began:
            self._save()
        self._network.load_state_dict(read_weights(self._folder.best).part("network"))
        return Trained(
            network=self._network.eval(),
            best=best,
            steps=self._step,
            last_loss=float(self._log[-1]["loss"]),
        )

    def _advance(self) -> None:
        """Make one step, and look at held-out examples where it is time to."""
        config, task = self._config, self._task
        self._network.train()
        rows = rows_of_step(self._step, task.examples, config.batch_size, config.seed)
        losses = task.losses(self._network, rows)
        self._optimizer.zero_grad(set_to_none=True)
        torch.autograd.backward(losses["loss"])
        if config.gradient_clip is not None:
            nn.utils.clip_grad_norm_(self._network.parameters(), config.gradient_clip)
        self._optimizer.step()
        self._step += 1
        values = {name: float(loss.detach()) for name, loss in losses.items()}
        self._check_finite(values)
        self._log.append({"step": self._step, **values})
        if self._step % config.validate_every == 0 or self._step == config.steps:
            self._validate()

    def _validate(self) -> Best:
        """Measure held-out examples, and keep the weights where they do best so far."""
        self._network.eval()
        # What is drawn here must not change what the steps after it draw.
        with torch.no_grad(), torch.random.fork_rng():
            torch.manual_seed(self._config.seed)
            measured = dict(self._task.validation(self._network))
        self._check_finite(measured)
        self._log[-1] = {**self._log[-1], "held_out": measured}
        if self._best is None or measured["loss"] < self._best.measured["loss"]:
            self._best = Best(step=self._step, measured=measured)
            self._best_weights = {
                f"network.{name}": tensor.clone()
                for name, tensor in self._network.state_dict().items()
            }
        return self._best

    def _save(self) -> None:
        """Save the state, the best weights, the log and the curves."""
        if self._best is not None and self._best_weights is not None:
            write_weights(self._folder.best, self._best_weights, asdict(self._best))
            self._best_weights = None
        write_checkpoint(
            self._folder.checkpoint,
            self._task,
            self._config,
            self._network,
            self._optimizer,
            step=self._step,
            best=self._best,
        )
        if self._log:
            self._folder.write_log(self._log)
            draw_curves(self._log, self._folder.curves)

    def _check_finite(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            if not math.isfinite(value):
                raise InputError(
                    f"{name} is no number any more after step {self._step}",
                    where=self._folder.root,
                    remedy="Train with a smaller learning rate, in another place",
                )


def _optimizer(network: nn.Module, config: TrainingConfig) -> Optimizer:
    kind: type[Adam | AdamW] = {"adam": Adam, "adamw": AdamW}[config.optimizer]
    return kind(
        network.parameters(),
        lr=config.learning_rate,
        betas=config.betas,
        weight_decay=config.weight_decay,
    )


def check_device(device: str) -> None:
    """Raise `InputError` where `device` is neither ``cpu`` nor a ``cuda`` that is there."""
    if device not in ("cpu", "cuda"):
        raise InputError(f"unknown device {device!r}", remedy="Use cpu or cuda")
    if device == "cuda" and not torch.cuda.is_available():
        raise InputError(
            "there is no graphics processor that torch can use here",
            remedy="Train on the processor (cpu), or install torch with CUDA",
        )


@contextmanager
def _repeatable(device: str) -> Iterator[None]:
    """Let torch use only algorithms that give the same result each time.

    A graphics processor has none for some layers, and is left as it is.
    """
    before = torch.get_deterministic_debug_mode()
    if device == "cpu":
        torch.set_deterministic_debug_mode("error")
    try:
        yield
    finally:
        torch.set_deterministic_debug_mode(before)
