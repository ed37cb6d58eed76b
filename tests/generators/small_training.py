"""Trainings of small networks on takes with given features."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from generators.registry import (
    Show,
    TrainedGenerator,
    TrainGenerator,
    TrainingRequest,
    show_nothing,
)
from training.config import TrainingConfig
from training.data.feature_cache import PreparedTakes
from training.data.take import Kind, TakeFolder
from training.run.task import WindowTask

Learn = Callable[..., TrainedGenerator]


def training_on(
    takes: PreparedTakes, train: TrainGenerator, monkeypatch: pytest.MonkeyPatch, **usual: Any
) -> Learn:
    """Return how to train the config tiny, with some of its settings changed."""

    def learn(
        steps: int,
        out: Path,
        prepared: PreparedTakes = takes,
        *,
        kind: Kind = "beat",
        show: Show = show_nothing,
        changes: Mapping[str, Any] = MappingProxyType({}),
        **choices: str | None,
    ) -> TrainedGenerator:
        monkeypatch.setattr("generators.learned.prepare", lambda *given, **options: prepared)
        speakers = sorted({take.speaker for take in prepared.takes})
        request = TrainingRequest(
            takes=TakeFolder(kind=kind, takes=prepared.takes, speakers=tuple(speakers)),
            out=out,
            cache=out.parent,
            config="tiny",
            changes={**usual, "steps": steps, **changes},
            choices={name: value for name, value in choices.items() if value is not None},
            show_training=show,
        )
        return train(request)

    return learn


class _ComputedError(Exception):
    """All losses were computed."""


def test_training_stays_on_its_device(
    learn: Learn, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """What begins to train brings no tensor of another device to its own; for modules' `learn`.

    torch's device ``meta`` holds shapes without values. Beside tensors of the processor it refuses
    to compute, as a GPU does.
    """

    def compute(task: WindowTask, config: TrainingConfig, *_: object, **__: object) -> None:
        elsewhere: Any = replace(task, device="meta")
        network = elsewhere.network()
        rows = np.arange(config.batch_size)
        for name in [one.name for one in config.passes] or [""]:
            elsewhere.losses(network, rows, name)["loss"].backward()
        raise _ComputedError

    monkeypatch.setattr("generators.learned.train", compute)
    with pytest.raises(_ComputedError):
        learn(8, tmp_path / "out.safetensors")
