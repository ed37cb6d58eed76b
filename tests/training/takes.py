"""Takes by name, and takes whose features are given as arrays."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter1d

from motion.arrays import Floats, Floats32
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
    arrays: Mapping[str, Sequence[Floats32]],
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


def takes_of_curves(
    features_of: Callable[[Floats], Mapping[str, Floats]],
    *,
    speakers: Sequence[str],
    frame_rate: float,
    frames: int = 70,
    curves: int = 1,
    skipped: tuple[InputError, ...] = (),
) -> PreparedTakes:
    """Return a take of each of `speakers` with features from smooth random curves.

    Every fourth is held out.
    """
    chance = np.random.default_rng(3)
    takes: list[Take] = []
    arrays: defaultdict[str, list[Floats32]] = defaultdict(list)
    for number, speaker in enumerate(speakers):
        noise = chance.standard_normal((frames, curves))
        for name, values in features_of(3 * gaussian_filter1d(noise, 2, axis=0)).items():
            arrays[name].append(values.astype(np.float32))
        split = "train" if number % 4 else "validation"
        takes.append(take_named(f"{number:02}", speaker=speaker, split=split))
    return prepared_takes(takes, arrays, frame_rate, skipped)
