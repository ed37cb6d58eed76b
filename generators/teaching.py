"""What trainers of generators do alike, before the steps of a training and behind them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypedDict, TypeVar

from torch import nn

from generators.trainable import TrainingRequest
from training.config import TrainingConfig
from training.data.feature import Feature
from training.data.feature_cache import PreparedTakes, prepare
from training.data.windows import Windows
from training.device import check_device
from training.run.facts import run_facts
from training.run.folder import RunFolder
from training.run.loop import Trained, train
from training.run.task import Task
from training.speakers import Speakers

Network = TypeVar("Network", bound=nn.Module)


def prepared_takes(
    request: TrainingRequest, features: Sequence[Feature], frame_rate: float
) -> PreparedTakes:
    """Return the request's recordings with their features.

    Raises
    ------
    InputError
        If the device is not usable, or no recording.
    """
    check_device(request.device)
    return prepare(
        request.takes,
        features,
        request.cache,
        frame_rate=frame_rate,
        show=request.show_preparing,
    )


class Cut(TypedDict):
    """The windows of a `training.window_task.WindowTask`."""

    training: Windows
    held_out: Windows


def cut_windows(
    prepared: PreparedTakes, frames: int, stride: int, *, held_out: int | None = None
) -> Cut:
    """Return windows to learn from, and held-out ones, side by side or so many frames apart."""
    return {
        "training": Windows(prepared, split="train", frames=frames, stride=stride),
        "held_out": Windows(prepared, split="validation", frames=frames, stride=held_out or frames),
    }


def learned_from(windows: Windows, speakers: Speakers) -> str:
    """Say how much somebody learned from, and from whom."""
    takes = sum(take.split == "train" for take in windows.prepared.takes)
    return (
        f"Learned from {len(windows)} windows of {takes} takes by {len(speakers.names)} speakers "
        f"({', '.join(speakers.names)})."
    )


def best_step_said(trained: Trained[Any]) -> str:
    """Say which step's weights were kept."""
    return f"Its weights are those of step {trained.best.step} of {trained.steps}."


def learn(
    request: TrainingRequest,
    task: Task[Network],
    config: TrainingConfig,
    packages: Sequence[str] = (),
) -> tuple[Trained[Network], dict[str, Any]]:
    """Return what came out of a training, and what the network's file says of it.

    Parameters
    ----------
    request : TrainingRequest
        Where it is kept, and whom to tell how it goes.
    task : Task
        What is learned.
    config : TrainingConfig
        How.
    packages : sequence of str
        What further was used, whose versions are told.
    """
    trained = train(task, config, RunFolder(request.run), show=request.show_training)
    facts = run_facts(config, trained, request.takes.kind, task.data_sha256, packages)
    return trained, {**facts, "ablation": request.choices.get("ablation")}
