"""The state of a run after a step: everything that the steps after it depend on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.optim import Optimizer

from generators.training.config import UNCOMPARED, TrainingConfig
from generators.training.task import Network, Task
from generators.training.weights_file import WeightsFile, read_weights, write_weights
from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Best:
    """The step that did best on held-out examples.

    Attributes
    ----------
    step : int
        Steps that had been made.
    measured : mapping of str to float
        What was measured then; ``loss`` among it.
    """

    step: int
    measured: Mapping[str, float]


def write_checkpoint(
    path: Path,
    task: Task[Network],
    config: TrainingConfig,
    network: nn.Module,
    optimizer: Optimizer,
    *,
    step: int,
    best: Best | None,
) -> None:
    """Save the state after `step` steps: weights, optimizer and random generators.

    The order of examples needs no state: `generators.training.batch_order` tells it from the seed
    and the step.
    """
    tensors: dict[str, Tensor] = {
        f"network.{name}": tensor for name, tensor in network.state_dict().items()
    }
    for index, state in optimizer.state_dict()["state"].items():
        tensors |= {f"optimizer.{index}.{name}": tensor for name, tensor in state.items()}
    tensors["random.cpu"] = torch.get_rng_state()
    if task.device == "cuda":
        tensors["random.cuda"] = torch.cuda.get_rng_state()
    facts = {
        "step": step,
        "best": None if best is None else asdict(best),
        "training": config.facts(),
        "task": dict(task.settings),
        "data_sha256": task.data_sha256,
    }
    write_weights(path, tensors, facts)


def restore_checkpoint(
    path: Path,
    task: Task[Network],
    config: TrainingConfig,
    network: nn.Module,
    optimizer: Optimizer,
) -> tuple[int, Best | None]:
    """Put a saved state into `network`, `optimizer` and torch's random generators.

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
    network.load_state_dict(saved.part("network"))
    states: dict[int, dict[str, Tensor]] = {}
    for name, tensor in saved.part("optimizer").items():
        index, _, key = name.partition(".")
        states.setdefault(int(index), {})[key] = tensor
    groups = optimizer.state_dict()["param_groups"]
    optimizer.load_state_dict({"state": states, "param_groups": groups})
    torch.set_rng_state(saved.tensors["random.cpu"])
    if task.device == "cuda" and "random.cuda" in saved.tensors:
        torch.cuda.set_rng_state(saved.tensors["random.cuda"])
    best = saved.facts["best"]
    return int(saved.facts["step"]), None if best is None else Best(**best)


def _check_same(
    saved: WeightsFile, path: Path, task: Task[Network], config: TrainingConfig
) -> None:
    """Raise where the saved run is another one, or has made more steps than are wanted."""
    try:
        before = {
            "training": dict(saved.facts["training"]),
            "task": dict(saved.facts["task"]),
            "data": {"sha256": saved.facts["data_sha256"]},
        }
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            "the file is no saved state of a training run",
            where=path,
            remedy="Remove it, or name another run folder",
        ) from error
    wanted = {
        "training": config.facts(),
        "task": dict(task.settings),
        "data": {"sha256": task.data_sha256},
    }
    differences = [
        f"{part} {name} was {before[part].get(name)!r} and is {wanted[part].get(name)!r}"
        for part in wanted
        for name in sorted(before[part].keys() | wanted[part].keys())
        if name not in UNCOMPARED and before[part].get(name) != wanted[part].get(name)
    ]
    if differences:
        raise InputError(
            f"the run that was begun here is another one: {'; '.join(differences)}",
            where=path.parent,
            remedy="Give the same settings and data to go on, or begin anew in another place",
        )
    if saved.facts["step"] > config.steps:
        raise InputError(
            f"the run has made {saved.facts['step']} steps, more than the {config.steps} wanted",
            where=path.parent,
            remedy="Ask for at least as many steps, or begin anew in another place",
        )
