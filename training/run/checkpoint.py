"""The state of a run after a step: everything that the steps after it depend on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from motion.errors import InputError
from training.config import CHANGEABLE_SETTINGS, TrainingConfig
from training.run.learner import Learner
from training.run.task import Network, Task
from training.weights_file import WeightsFile, read_weights, write_weights


@dataclass(frozen=True, kw_only=True)
class Best:
    """The best step on held-out examples.

    Attributes
    ----------
    step : int
        Steps that had been made.
    measured : mapping of str to float
        Its held-out measures.
    """

    step: int
    measured: Mapping[str, float]


def write_checkpoint(
    path: Path,
    task: Task[Network],
    config: TrainingConfig,
    learner: Learner[Network],
    *,
    step: int,
    best: Best | None,
) -> None:
    """Save the state after `step` steps.

    Order of examples and chance need no state: `training.run.batches` derives both from the seed
    and the step.
    """
    facts = {
        "step": step,
        "best": None if best is None else asdict(best),
        "learner": learner.facts(),
        "training": config.facts(),
        "task": dict(task.settings),
        "data_sha256": task.data_sha256,
    }
    write_weights(path, learner.tensors(), facts)


def restore_checkpoint(
    path: Path, task: Task[Network], config: TrainingConfig, learner: Learner[Network]
) -> tuple[int, Best | None]:
    """Put a saved state into `learner`.

    Returns
    -------
    step : int
        Steps that were made.
    best : Best or None
        The best of them.

    Raises
    ------
    InputError
        If the file cannot be read, or is of another task, configuration or data; the message
        names every difference.
    """
    saved = read_weights(path)
    _check_same(saved, path, task, config)
    parts = {name: saved.with_prefix(name) for name in ("network", "optimizer", "average")}
    learner.restore(parts, saved.facts["learner"])
    best = saved.facts["best"]
    return int(saved.facts["step"]), None if best is None else Best(**best)


def _check_same(
    saved: WeightsFile, path: Path, task: Task[Network], config: TrainingConfig
) -> None:
    """Raise `InputError` if the saved run is another one, or has made more steps than requested."""
    if not saved.facts.keys() >= {"step", "best", "learner", "training", "task", "data_sha256"}:
        raise InputError(
            "the file is not a saved state of a training run, or is of an older version",
            where=path,
            remedy="Remove it, or name another run folder",
        )
    previous = {
        "training": dict(saved.facts["training"]),
        "task": dict(saved.facts["task"]),
        "data": {"sha256": saved.facts["data_sha256"]},
    }
    current = {
        "training": config.facts(),
        "task": dict(task.settings),
        "data": {"sha256": task.data_sha256},
    }
    differences = [
        f"{part} {name} was {previous[part].get(name)!r} and is {current[part].get(name)!r}"
        for part in current
        for name in sorted(previous[part].keys() | current[part].keys())
        if name not in CHANGEABLE_SETTINGS and previous[part].get(name) != current[part].get(name)
    ]
    if differences:
        raise InputError(
            f"the run that was started here is another one: {'; '.join(differences)}",
            where=path.parent,
            remedy="Give the same settings and data to go on, or start again in another place",
        )
    if saved.facts["step"] > config.steps:
        raise InputError(
            f"the run has made {saved.facts['step']} steps, more than the {config.steps} wanted",
            where=path.parent,
            remedy="Ask for at least as many steps, or start again in another place",
        )
