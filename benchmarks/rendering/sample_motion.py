"""The motion used in all measurements."""

import numpy as np

from motion.clip import MotionClip
from motion.skeleton import joint_index


def gesturing_clip(seconds: float, frame_rate: float) -> MotionClip:
    """Return a clip in which arms, head and jaw move constantly."""
    time_of = np.arange(round(seconds * frame_rate)) / frame_rate
    poses = np.zeros((len(time_of), 55, 3), np.float32)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        poses[:, joint_index(f"{side}_shoulder")] = (0.0, 0.0, sign * 1.15)
        poses[:, joint_index(f"{side}_elbow"), 1] = sign * (1.2 + 0.4 * np.sin(3 * time_of))
    poses[:, joint_index("head"), 1] = 0.2 * np.sin(1.3 * time_of)
    poses[:, joint_index("jaw"), 0] = 0.1 + 0.1 * np.sin(14 * time_of)
    return MotionClip(
        poses=poses, trans=np.zeros((len(time_of), 3), np.float32), frame_rate=frame_rate
    )
