"""The loop that trains every network, and the saved state from which it resumes."""

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Generic

import torch
from torch import Tensor

from motion.errors import InputError
from training.config import CHANGEABLE_SETTINGS, TrainingConfig
from training.device import check_device
from training.run.group import Group
from training.run.launching import stop_request
from training.run.learner import Learner
from training.run.records import RunFolder, RunLog, draw_curves
from training.run.task import Network, Task
from training.weights_file import read_weights, write_weights

Show = Callable[[int, int, str], None]
"""Called with the number of steps done, the number of all steps, and the loss in words."""


@dataclass(frozen=True, kw_only=True)
class Best:
    """The best step on held-out examples.

    Attributes
    ----------
    step : int
        Number of steps made.
    measured : mapping of str to float
        Measures of held-out examples after it.
    """

    step: int
    measured: Mapping[str, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Trained(Generic[Network]):
    """The result of a run.

    Attributes
    ----------
    network : Module
        The network with the best weights on held-out examples, in evaluation mode.
    best : Best
        The step of the best weights, and its measures.
    steps : int
        Number of steps made in all.
    last_loss : float
        Loss of the last step.
    """

    network: Network
    best: Best
    steps: int
    last_loss: float


class TrainingStopped(KeyboardInterrupt):
    """A stop was requested; the state was saved, and the same call resumes from it.

    Attributes
    ----------
    step, steps : int
        Numbers of steps made and requested.
    """

    def __init__(self, step: int, steps: int) -> None:
        super().__init__(f"stopped after step {step} of {steps}")
        self.step = step
        self.steps = steps


def train(
    task: Task[Network], config: TrainingConfig, folder: RunFolder, *, show: Show | None = None
) -> Trained[Network]:
    """Train a network, resuming where an earlier call stopped.

    However often a run is stopped and resumed, weights, log and curves are the same bytes on the
    CPU of one machine with one number of threads. On a GPU, runs diverge by rounding. Several
    processes (`training.run.group`) make the same call and get the result of a single one, up to
    rounding.

    Parameters
    ----------
    task : Task
        Network, examples and loss.
    config : TrainingConfig
        The settings.
    folder : RunFolder
        The run's folder; made if needed. All processes read it, the leading one writes.
    show : callable, optional
        Called with the progress, in the leading process.

    Raises
    ------
    InputError
        If `folder` has another run, a loss is not a number, or the device is missing.
    TrainingStopped
        After SIGINT (Ctrl-C) or SIGTERM; the state is saved.
    """
    check_device(task.device)
    group = Group(task.device)
    if group.leads:
        # Before training rather than at the first save, in case the folder cannot be written.
        folder.root.mkdir(parents=True, exist_ok=True)
    gpus = [torch.cuda.current_device()] if task.device == "cuda" else []
    with torch.random.fork_rng(devices=gpus), _deterministic(task.device):
        torch.manual_seed(config.seed)
        progress = show if group.leads else None
        return _Run(task, config, folder, group, progress or (lambda *_: None)).finish()


class _Run(Generic[Network]):
    """A run in progress."""

    def __init__(
        self,
        task: Task[Network],
        config: TrainingConfig,
        folder: RunFolder,
        group: Group,
        show: Show,
    ) -> None:
        self._task = task
        self._config = config
        self._folder = folder
        self._group = group
        self._show = show
        self._learner = Learner(task, config, group)
        self._step = self._drawn = 0
        self._best: Best | None = None
        self._best_weights: dict[str, Tensor] | None = None
        if folder.checkpoint.exists():
            self._restore(folder.checkpoint)
        self._log = RunLog(folder.log, steps=self._step)
        self._check_alike()

    def _restore(self, path: Path) -> None:
        """Resume from a saved state.

        Order of examples and randomness have no state: `training.run.batches` derives both from the
        seed and the step.
        """
        saved = read_weights(path)
        self._check_same(saved.facts, path)
        parts = {name: saved.with_prefix(name) for name in ("network", "optimizer", "average")}
        self._learner.restore(parts)
        self._step = int(saved.facts["step"])
        best = saved.facts["best"]
        self._best = None if best is None else Best(**best)

    def finish(self) -> Trained[Network]:
        """Make the remaining steps."""
        steps = self._config.steps
        with stop_request(heeded=1 if self._group.size == 1 else 2) as stop:
            while self._step < steps:
                if self._group.any(bool(stop)):
                    self._save(drawn=True)
                    raise TrainingStopped(self._step, steps)
                self._advance()
                if self._step % self._config.checkpoint_every == 0 and self._step < steps:
                    self._save(drawn=False)
                self._show(self._step, steps, f"loss {self._log.last_loss:.4g}")
            best = self._best
            if best is None or not self._log.ends_in_validation:
                best = self._validate()
                self._save(drawn=True)
        network = self._learner.network
        if self._group.leads:
            network.load_state_dict(read_weights(self._folder.best).with_prefix("network"))
        self._group.hand_out(network.state_dict().values())
        return Trained(
            network=network.eval(),
            best=best,
            steps=self._step,
            last_loss=self._log.last_loss,
        )

    def _advance(self) -> None:
        """Make one step, and validate if it is due."""
        losses = self._learner.learn(self._step)
        rates = self._learner.learning_rates(self._step)
        self._step += 1
        self._check_finite(losses)
        self._log.lines.append({"step": self._step, **rates, **losses})
        if self._step % self._config.validate_every == 0 and self._step < self._config.steps:
            self._validate()

    def _validate(self) -> Best:
        """Validate, and keep the weights if they are the best so far."""
        measured = self._group.from_leader(self._measure() if self._group.leads else {})
        self._check_finite(measured)
        self._log.lines.append({"step": self._step, "held_out": measured})
        chosen_by = next(iter(measured))
        last_stage = max((update_pass.first for update_pass in self._config.passes), default=0)
        if (
            self._best is None
            # Weights of an earlier stage lack the training of the last stage.
            or self._best.step <= last_stage < self._step
            or measured[chosen_by] < self._best.measured[chosen_by]
        ):
            self._best = Best(step=self._step, measured=measured)
            if self._group.leads:
                self._best_weights = {
                    f"network.{name}": tensor.clone()
                    for name, tensor in self._learner.network.state_dict().items()
                }
        return self._best

    def _measure(self) -> dict[str, float]:
        network = self._learner.network.eval()
        with torch.no_grad():
            torch.manual_seed(self._config.seed)
            return dict(self._task.validation(network))

    def _save(self, *, drawn: bool) -> None:
        """Save the state, the best weights and the log; draw the curves if `drawn` or outdated."""
        if not self._group.leads:
            return
        if self._best is not None and self._best_weights is not None:
            write_weights(self._folder.best, self._best_weights, asdict(self._best))
            self._best_weights = None
        self._log.save()
        # A long log takes a second to draw, and looks the same after a few more steps.
        if self._log.lines and (drawn or self._step >= 1.1 * self._drawn):
            best_step = None if self._best is None else self._best.step
            draw_curves(self._log.lines, self._folder.curves, kept_step=best_step)
            self._drawn = self._step
        # The state comes last: after a crash before it, everything else is written again.
        state = {
            "step": self._step,
            "best": None if self._best is None else asdict(self._best),
            "identity": self._identity(),
        }
        write_weights(self._folder.checkpoint, self._learner.tensors(), state)

    def _check_finite(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            if not math.isfinite(value):
                raise InputError(
                    f"{name} is no longer a number after step {self._step}",
                    where=self._folder.root,
                    remedy="Train with a smaller learning rate, in another folder",
                )

    def _identity(self) -> dict[str, Any]:
        """Return the settings and data that a run must share with the one that it resumes."""
        training = {f"training {name}": v for name, v in self._config.facts().items()}
        task = {f"task {name}": value for name, value in self._task.settings.items()}
        facts: dict[str, Any] = json.loads(json.dumps(training | task))
        return facts | {"data sha256": self._task.data_sha256}

    def _check_same(self, saved: Mapping[str, Any], path: Path) -> None:
        """Raise `InputError` if the saved run is another one, or has made too many steps."""
        before, now = saved.get("identity", {}), self._identity()
        differences = [
            f"{name} was {before.get(name)!r} and is {now.get(name)!r}"
            for name in sorted(before.keys() | now.keys())
            if name not in CHANGEABLE_SETTINGS and before.get(name) != now.get(name)
        ]
        if not differences and saved["step"] > self._config.steps:
            differences = [f"it made {saved['step']} steps, more than {self._config.steps}"]
        if differences:
            raise InputError(
                f"the run that was started here is another one: {'; '.join(differences)}",
                where=path.parent,
                remedy="Resume with the same settings and data, or start again in another folder",
            )

    def _check_alike(self) -> None:
        """Raise `InputError` if run or data differ from those of the leading process."""
        state = (self._step, self._task.data_sha256, self._config.facts())
        if self._group.any(state != self._group.from_leader(state)):
            raise InputError(
                "the processes that train together see different runs or data",
                where=self._folder.root,
                remedy="Give all of them the same command, data and run folder, on a disk that all "
                "machines share",
            )


@contextmanager
def _deterministic(device: str) -> Iterator[None]:
    """Make torch use deterministic algorithms only.

    Nothing changes on a GPU, where some layers have no deterministic algorithm.
    """
    previous = torch.get_deterministic_debug_mode()
    if device == "cpu":
        torch.set_deterministic_debug_mode("error")
    try:
        yield
    finally:
        torch.set_deterministic_debug_mode(previous)
