"""Making a clip as long as the speech it is to go with."""

from __future__ import annotations

import numpy as np

from motion.clip import MotionClip


def with_length(clip: MotionClip, frames: int) -> MotionClip:
    """Return `clip` cut to `frames`, or continued without a jump where it is too short.

    It continues by running backwards from its last frame, then forwards again from its first.
    """
    there_and_back = np.concatenate([np.arange(len(clip)), np.arange(len(clip) - 2, 0, -1)])
    return clip.frames(np.resize(there_and_back, frames))
