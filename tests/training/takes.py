"""Takes by name, and takes whose features are given as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from training.data.feature_cache import PreparedTakes
from training.data.take import Take


def take_named(name: str, folder: Path = Path(), **facts: Any) -> Take:
    """Return a take to learn from, whose files lie in `folder` under its name."""
    usual: dict[str, Any] = {
        "speaker": "scott",
        "emotion": "",
        "split": "train",
        "speech": folder / f"{name}.wav",
        "motion": folder / f"{name}.bvh",
    }
    return Take(name=name, **(usual | facts))


def prepared_takes(
    takes: Sequence[Take],
    arrays: Mapping[str, Sequence[NDArray[np.float32]]],
    frame_rate: float,
    skipped: tuple[InputError, ...] = (),
) -> PreparedTakes:
    """Return takes with given features."""
    return PreparedTakes(
        takes=tuple(takes),
        arrays={name: tuple(values) for name, values in arrays.items()},
        frame_rate=frame_rate,
        skipped=skipped,
        sha256="c" * 64,
    )
