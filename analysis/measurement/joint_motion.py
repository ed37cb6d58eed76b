"""What a clip's joints do on the default body."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.kept_arrays import Kind
from motion.clip import MotionClip
from motion.ground import stand_on_ground
from motion.resample import resample
from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_COUNT, forward_kinematics

FloatArray = NDArray[np.float64]

JOINTS: Final = Kind("joints", "1", (None, JOINT_COUNT + 1, 3))


@dataclass(frozen=True, kw_only=True, eq=False)
class JointMotion:
    """Where the joints of one clip are.

    Attributes
    ----------
    relative : ndarray, shape (T, 55, 3), float64
        Positions relative to the pelvis in metres, y up.
    pelvis : ndarray, shape (T, 3), float64
        Where the pelvis is in the world, in metres, the feet standing on the ground as in videos.
        All values are of single precision, whether they were computed or read.
    """

    relative: FloatArray
    pelvis: FloatArray

    @classmethod
    def of(cls, packed: NDArray[np.float32]) -> JointMotion:
        """Return what `packed_joints` packed."""
        values = packed.astype(np.float64)
        return cls(relative=values[:, :JOINT_COUNT], pelvis=values[:, JOINT_COUNT])


def joint_motion(clip: MotionClip, frame_rate: float) -> JointMotion:
    """Return where all joints are, on the default body, whatever the clip's own shape.

    Parameters
    ----------
    clip : MotionClip
        Any frame rate.
    frame_rate : float
        Frames per second of the result.
    """
    return JointMotion.of(packed_joints(clip, frame_rate))


def packed_joints(clip: MotionClip, frame_rate: float) -> NDArray[np.float32]:
    """Return a `joint_motion` as one array, shape (T, 56, 3): the pelvis comes last."""
    seen = stand_on_ground(resample(clip, frame_rate), REST_JOINTS)
    relative = forward_kinematics(seen.poses, np.zeros_like(seen.trans), REST_JOINTS)[0]
    relative -= relative[:, :1]
    pelvis = REST_JOINTS[0] + seen.trans
    return np.concatenate([relative, pelvis[:, None]], axis=1).astype(np.float32)
