"""Trainings of a few steps without drawing curves."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest

from training.device import torch_threads
from training.run.records import LogLine


@contextmanager
def short_training() -> Iterator[None]:
    """Leave torch one thread, since threads would wait for other tests, and draw no curves.

    Drawing takes longer than a few steps; what would be drawn is written instead.
    """
    with torch_threads(1), pytest.MonkeyPatch.context() as patch:
        patch.setattr("training.run.loop.draw_curves", _write_lines)
        yield


@pytest.fixture(scope="module", autouse=True)
def trained_shortly() -> Iterator[None]:
    """Let `short_training` hold in the tests beside a conftest that imports this."""
    with short_training():
        yield


def _write_lines(lines: Sequence[LogLine], path: Path, *, kept_step: int | None) -> None:
    path.write_text(json.dumps([list(lines), kept_step]), encoding="utf-8")
