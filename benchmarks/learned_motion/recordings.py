"""The corpus' recorded motion as clips of our body, processed like a network's motion."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.formats import write_clip
from training.data.take import Take
from training.features import beat_expression, beat_gesture
from training.spaces.beat import beat_clip

FRAME_RATE: Final = 15
"""Frames per second of all measurements: the network's own, so that no frames are interpolated."""


def recorded_clip(take: Take) -> MotionClip:
    """Return the recorded motion of a take, processed like a network's motion.

    Raises
    ------
    InputError
        If a file of the take cannot be used.
    """
    body, face = (feature(FRAME_RATE).compute(take) for feature in (beat_gesture, beat_expression))
    frames = min(len(body), len(face))
    values = np.concatenate([body[:frames], face[:frames]], axis=1, dtype=np.float64)
    return beat_clip(values, FRAME_RATE).with_provenance(source=take.motion.name)


def write_recordings(takes: Iterable[Take], place: Callable[[Take], Path]) -> dict[str, Path]:
    """Write the missing clips, and return the path of each take's clip."""
    paths = {}
    for take in takes:
        paths[take.name] = path = place(take)
        if not path.exists():
            write_clip(path, recorded_clip(take))
    return paths
