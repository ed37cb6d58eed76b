"""Whether a training computes on its own device alone, without a graphics processor."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from training.config import TrainingConfig
from training.run.task import WindowTask


class _ComputedError(Exception):
    """All losses were computed."""


def require_one_device(monkeypatch: pytest.MonkeyPatch, learn: Callable[[], object]) -> None:
    """Require that what `learn` begins to train brings no tensor of another device to its own.

    torch's device ``meta`` holds shapes without values. Beside tensors of the processor it refuses
    to compute, as a graphics processor does.
    """

    def compute(task: WindowTask, config: TrainingConfig, *_: object, **__: object) -> None:
        elsewhere: Any = replace(task, device="meta")
        network = elsewhere.network()
        rows = np.arange(config.batch_size)
        for name in [one.name for one in config.passes] or [""]:
            losses = (
                elsewhere.losses_of(name, network, rows)
                if name
                else elsewhere.losses(network, rows)
            )
            losses["loss"].backward()
        raise _ComputedError

    monkeypatch.setattr("generators.learned.train", compute)
    with pytest.raises(_ComputedError):
        learn()
