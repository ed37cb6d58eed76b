"""First rows of BVH files that are no part of the motion."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.formats.bvh import BvhMotion

_STILL: Final = 1e-3
"""Change of a channel, in degrees or length units, below which it does not move."""

_JUMP: Final = 180.0
"""Degrees, summed over all joints, that a calibration pose is at least away from the motion."""

_JUMPS_AS_LARGE: Final = 3.0
"""How many times the later changes from row to row that must be."""

_NEARLY_ALL: Final = 0.95
"""Share of the later changes that counts: a glitch somewhere is not a reason to show a T-pose."""


def settle_first_frame(motion: BvhMotion) -> BvhMotion:
    """Return `motion` without a pose left over in its first row.

    Motion capture software writes the T-pose in which it calibrated the skeleton as the first row;
    it is kept apart as `BvhMotion.calibration`. Files cut down to some joints (BEAT's as prepared
    for its baselines) still hold all joints in row 0 while the others stay at one value from row 1
    on. Both would make the body jump once; what was left over takes its values of row 1 there.
    """
    return _without_leftover_joints(_without_calibration(motion))


def _without_calibration(motion: BvhMotion) -> BvhMotion:
    """Take a first row that stands apart from all others out of the motion."""
    if len(motion.values) < 3 or np.abs(motion.values[0] - motion.values[1]).max() <= _STILL:
        return motion
    # The first step alone tells nearly always, and a recording has thousands.
    if _changes(replace(motion, values=motion.values[:2]))[0] < _JUMP:
        return motion
    changes = _changes(motion)
    if changes[0] < max(_JUMP, _JUMPS_AS_LARGE * np.quantile(changes[1:], _NEARLY_ALL)):
        return motion
    values = motion.values.copy()
    values[0] = values[1]
    note = "the first frame is a pose apart from the motion; the second is shown in its place"
    return replace(motion, values=values, calibration=motion.values[0], notes=(*motion.notes, note))


def _changes(motion: BvhMotion) -> NDArray[np.float64]:
    """Return by how many degrees all joints turn from each row to the next, shape (T - 1,)."""
    turns = motion.local_rotations()
    steps = np.swapaxes(turns[:-1], 2, 3) @ turns[1:]
    angles = Rotation.from_matrix(steps.reshape(-1, 3, 3)).magnitude()
    return np.asarray(np.degrees(angles.reshape(len(steps), -1)).sum(axis=1))


def _without_leftover_joints(motion: BvhMotion) -> BvhMotion:
    """Give joints that never move after row 0 their later values there too."""
    values = motion.values.copy()
    settled = 0
    for index in range(len(motion.joints)):
        columns = values[:, motion.columns(index)]
        if len(columns) < 3 or not columns.shape[1]:
            continue
        still_later = np.ptp(columns[1:], axis=0).max() <= _STILL
        if still_later and np.abs(columns[0] - columns[1]).max() > _STILL:
            columns[0] = columns[1]
            settled += 1
    if not settled:
        return motion
    note = (
        f"{settled} joints that never move after the first frame had another pose in it; "
        "they take their later values there"
    )
    return replace(motion, values=values, notes=(*motion.notes, note))
