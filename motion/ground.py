"""Keeping the feet on the ground where a motion does not say how high the body is.

Data sets often hold no translation, or drop it. The legs then move while the pelvis hangs in the
air, and feet hover or sink.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import correlate1d

from motion.clip import MotionClip
from motion.skeleton import forward_kinematics, joint_index

FloatArray = NDArray[np.float64]

_STILL: Final = 1e-4
"""Metres within which a height that never changes lies; less than any recording's noise."""

SINKS_AT_MOST: Final = 0.004
"""Metres that a sole may be below the ground."""

_SMOOTHED_OVER: Final = 0.1
"""Seconds before and after a frame that its height may depend on."""

_BEHIND_ANKLE: Final = 0.7
_BEFORE_TOES: Final = 1.0
"""How far heel and toes reach beyond ankle and foot joint, as shares of the way between those."""

_SIDES: Final = ("left", "right")


def stand_on_ground(clip: MotionClip, rest_joints: NDArray[np.floating]) -> MotionClip:
    """Return `clip` with its lower foot on the ground in every frame, if its height says nothing.

    Parameters
    ----------
    clip : MotionClip
        The motion. Where its height changes at all it is returned as it is.
    rest_joints : ndarray, shape (55, 3)
        Joints of the unposed body that it is put on, in metres.

    Returns
    -------
    MotionClip
        Only `trans` differs, and only in height. No sole is further below the ground than
        `SINKS_AT_MOST`; the height changes smoothly, so that soles may be a little above it while
        the legs move fast. Sliding of the feet along the ground is left: without translation
        nobody knows where the body went.
    """
    if np.ptp(clip.trans[:, 1]) > _STILL:
        return clip
    lift = ground_height(rest_joints) - sole_heights(clip, rest_joints)
    trans = clip.trans.copy()
    trans[:, 1] += _smooth(lift, round(_SMOOTHED_OVER * clip.frame_rate))
    return replace(clip, trans=trans)


def ground_height(rest_joints: NDArray[np.floating]) -> float:
    """Return the height of the soles' joints of the unposed body, in metres.

    The soles themselves lie lower by what is between the joints and the floor.
    """
    return float(min(rest_joints[joint_index(f"{side}_foot"), 1] for side in _SIDES))


def sole_heights(clip: MotionClip, rest_joints: NDArray[np.floating]) -> FloatArray:
    """Return how high the lowest of both heels and toes is in each frame, shape (T,), in metres.

    They are the ends of a flat plate at the height of the foot's joint, which turns with the foot.
    """
    positions, turned = forward_kinematics(clip.poses, clip.trans, rest_joints)
    heights = []
    for side in _SIDES:
        ankle, foot = joint_index(f"{side}_ankle"), joint_index(f"{side}_foot")
        along = rest_joints[foot] - rest_joints[ankle]
        heel = np.array([-_BEHIND_ANKLE, 1.0, -_BEHIND_ANKLE]) * along
        toes = np.array([_BEFORE_TOES, 0.0, _BEFORE_TOES]) * along
        for joint, offset in ((ankle, heel), (foot, toes)):
            heights.append((positions[:, joint] + turned[:, joint] @ offset)[:, 1])
    return np.asarray(np.min(heights, axis=0))


def _smooth(lift: FloatArray, reach: int) -> FloatArray:
    """Return `lift` averaged with what is within `reach` frames, and hardly anywhere below it."""
    weights = np.hanning(2 * reach + 3)[1:-1]
    smooth = correlate1d(lift, weights / weights.sum(), mode="nearest")
    return np.maximum(smooth, lift - SINKS_AT_MOST)
