"""The pose in which simplified limbs are compared with the whole ones: everything bends."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.body.skinning import skinning_matrices
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, joint_index
from tools.avatars.smplx_rig import unpose

Array = NDArray[np.float64]

_FINGER_BEND: Final = 1.3
_ELBOW_BEND: Final = 1.6
_KNEE_BEND: Final = 1.2


def bent(vertices: Array, weights: Array, t_pose: Array, poses: Array, stance: Array) -> Array:
    """Return `vertices`, given in stance, with elbows, knees and fingers bent.

    Parameters
    ----------
    vertices : ndarray, shape (n, 3)
        In metres.
    weights : ndarray, shape (n, 55)
        Skin weights.
    t_pose, stance : ndarray, shape (55, 3)
        Where the joints are in T-pose and in stance.
    poses : ndarray, shape (55, 3)
        The poses from the one to the other.
    """
    straight = unpose(vertices, weights, t_pose, poses, stance)
    bends = np.zeros((1, JOINT_COUNT, 3))
    for side, sign in (("left", -1.0), ("right", 1.0)):
        bends[0, joint_index(f"{side}_elbow"), 1] = sign * _ELBOW_BEND
        bends[0, joint_index(f"{side}_knee"), 0] = _KNEE_BEND
        for number, name in enumerate(JOINT_NAMES):
            if name.startswith(f"{side}_") and name[-1] in "123" and "thumb" not in name:
                bends[0, number, 2] = sign * _FINGER_BEND
    matrices = skinning_matrices(bends, np.zeros((1, 3)), t_pose, None)[0]
    blended = np.einsum("vj,jab->vab", weights, matrices)
    return np.asarray(np.einsum("vab,vb->va", blended[..., :3], straight) + blended[..., 3])
