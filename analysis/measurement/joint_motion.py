"""What a clip's joints do on the default body: computed once per clip, and kept on disk."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.kept_arrays import KeptArrays
from analysis.measurement.seen_motion import SeenMotion
from motion.clip import MotionClip
from motion.ground import stand_on_ground
from motion.resample import resample
from motion.rest_pose import REST_JOINTS
from motion.skeleton import JOINT_COUNT, forward_kinematics

FloatArray = NDArray[np.float64]

VERSION: Final = "1"
"""Raised whenever the joints of the same motion file come to lie elsewhere."""


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


def joint_motion(clip: MotionClip, frame_rate: float) -> JointMotion:
    """Return where all joints are, on the default body, whatever the clip's own shape.

    Parameters
    ----------
    clip : MotionClip
        Any frame rate.
    frame_rate : float
        Frames per second of the result.
    """
    seen = stand_on_ground(resample(clip, frame_rate), REST_JOINTS)
    relative = forward_kinematics(seen.poses, np.zeros_like(seen.trans), REST_JOINTS)[0]
    relative -= relative[:, :1]
    pelvis = REST_JOINTS[0] + seen.trans
    return _unpacked(np.concatenate([relative, pelvis[:, None]], axis=1).astype(np.float32))


class JointMotionStore:
    """Joint motions kept in a folder, found again by the content of the motion file.

    Parameters
    ----------
    folder : Path
        Made when the first joint motion is kept.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._kept = KeptArrays(folder, "joints", VERSION)

    def place(self, path: Path, frame_rate: float, motion: SeenMotion) -> Path:
        """Return where the joint motion of the file at `path` is kept, whether it is there or not.

        Parameters
        ----------
        path : Path
            The motion file.
        frame_rate : float
            Frames per second of the joint motion.
        motion : SeenMotion
            How the file is read.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        return self._kept.place(path, f"{frame_rate!r} {motion}")

    @staticmethod
    def read(place: Path) -> JointMotion | None:
        """Return what is kept at `place`; None where nothing whole is."""
        packed = KeptArrays.read(place, (None, JOINT_COUNT + 1, 3))
        return None if packed is None else _unpacked(packed)

    @staticmethod
    def keep(place: Path, motion: JointMotion) -> None:
        """Keep `motion` at `place`, in one step."""
        packed = np.concatenate([motion.relative, motion.pelvis[:, None]], axis=1)
        KeptArrays.keep(place, packed.astype(np.float32))

    def forget_others(self, used: Collection[Path], frame_rate: float, motion: SeenMotion) -> None:
        """Remove what is kept under these settings but no longer `used`."""
        self._kept.forget(f"{frame_rate!r} {motion}", used)


def _unpacked(packed: NDArray[np.float32]) -> JointMotion:
    values = packed.astype(np.float64)
    return JointMotion(relative=values[:, :JOINT_COUNT], pelvis=values[:, JOINT_COUNT])
