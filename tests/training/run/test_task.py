"""A task of windows says what it learns from, and what makes it another one."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from tests.training.toy_takes import toy_takes
from training.data.windows import Windows
from training.run.task import WindowTask


@dataclass(frozen=True)
class _Sizes:
    width: int = 3
    parts: tuple[tuple[int, ...], ...] = ((0, 1), (2,))


@dataclass(frozen=True)
class _Weights:
    velocity: float = 1.0


@pytest.fixture
def task() -> WindowTask:
    takes = toy_takes()
    return WindowTask(
        config=_Sizes(),
        weights=_Weights(),
        training=Windows(takes, split="train", frames=10, stride=10),
        held_out=Windows(takes, split="validation", frames=10, stride=10),
        further={"heard by": "nobody"},
    )


def test_sizes_weights_and_device_make_it_another_one(task: WindowTask) -> None:
    others = [
        replace(task, config=_Sizes(parts=((0,), (1, 2)))),
        replace(task, weights=_Weights(velocity=0.0)),
        replace(task, further={}),
        replace(task, device="cuda"),
    ]
    assert all(other.settings != task.settings for other in others)
