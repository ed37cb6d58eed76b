"""Letting wrist and elbow share the twist of a forearm whose skeleton had it in one of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.body.skinning import twist_angles
from motion.rest_pose import REST_JOINTS
from motion.skeleton import joint_index

FloatArray = NDArray[np.float64]

_SIDES: Final = ("left", "right")


@dataclass(frozen=True)
class ForearmTwists:
    """How far a motion's forearms were twisted when it was left; what follows goes on from there.

    Attributes
    ----------
    angles : ndarray, shape (2, 2)
        Of left and right, elbow and wrist, in radians from -pi to pi.
    turns : ndarray, shape (2, 2)
        Whole turns that each has made besides.
    """

    angles: FloatArray
    turns: FloatArray


NO_TWISTS: Final = ForearmTwists(np.zeros((2, 2)), np.zeros((2, 2)))
"""Of forearms whose twists are left as they are."""


def share_forearm_twist(local: FloatArray, before: ForearmTwists | None) -> ForearmTwists:
    """Let wrist and elbow take half each of how far the forearm is twisted; return the last twists.

    Other skeletons often turn the palm at the elbow alone, which wrings the skin there. No bone
    and no hand points elsewhere afterwards.

    Parameters
    ----------
    local : ndarray, shape (T, J, 3, 3)
        Rotation matrices of SMPL-X joints against their parents; those of elbows and wrists are
        written over.
    before : ForearmTwists or None
        What this returned for the frames before; None for the first.
    """
    last = []
    for index, side in enumerate(_SIDES):
        elbow, wrist = joint_index(f"{side}_elbow"), joint_index(f"{side}_wrist")
        axis = REST_JOINTS[wrist] - REST_JOINTS[elbow]
        axis = axis / np.linalg.norm(axis)
        angles = np.column_stack(
            [
                twist_angles(Rotation.from_matrix(local[:, joint]).as_quat(), axis)
                for joint in (elbow, wrist)
            ]
        )
        turns = _turns(
            angles, None if before is None else (before.angles[index], before.turns[index])
        )
        # Past half a turn an angle starts again at the other end; half of it would jump.
        twists = angles + 2 * np.pi * turns
        moved = (twists[:, 0] - twists[:, 1]) / 2
        turn = Rotation.from_rotvec(moved[:, None] * axis).as_matrix()
        local[:, elbow] = local[:, elbow] @ np.swapaxes(turn, 1, 2)
        local[:, wrist] = turn @ local[:, wrist]
        last.append((angles[-1], turns[-1]))
    return ForearmTwists(*(np.stack(values) for values in zip(*last, strict=True)))


def _turns(angles: FloatArray, before: tuple[FloatArray, FloatArray] | None) -> FloatArray:
    """Return how many whole turns each of `angles` (T, n) has made besides, going on smoothly."""
    angle, turns = (angles[0], np.zeros(angles.shape[1])) if before is None else before
    steps = np.diff(angles, axis=0, prepend=angle[None])
    return np.asarray(turns - np.cumsum(np.round(steps / (2 * np.pi)), axis=0))
