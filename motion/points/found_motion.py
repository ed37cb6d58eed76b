"""A clip of what a detector found in a stretch of video."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from motion.body.model import BodyModel
from motion.clearance import clear_of_body
from motion.clip import MotionClip
from motion.placement import place
from motion.points.detection import Detection
from motion.points.face_mesh import landmark_shifts
from motion.points.facial_actions import facial_actions
from motion.points.joint_rotations import LEGS, rotations_from_joints
from motion.points.person import MEDIAPIPE, body_joints
from motion.rest_pose import REST_JOINTS

FloatArray = NDArray[np.float64]

_ANCHORS: Final = 5.0
"""A second: what is detected is averaged around so many points in time and goes on smoothly between
them, which takes the jitter out (Bhattacharya et al. 2024, section 4)."""

_MISFIT: Final = 6e-3
"""Metres by which a detected face misses its facial actions, see `facial_actions`."""

_SEEN: Final = 0.5
"""Visibility that a joint has on average at least to count."""

_FEET: Final = ("heel", "foot_index", "ankle", "knee")
_HANDS: Final = ("elbow", "wrist", "pinky", "index", "thumb")


def clip_of_detection(found: Detection, body: BodyModel) -> MotionClip:
    """Return the motion of a person in a stretch of video, with the face in facial actions.

    Arms or legs that are not in the picture for most of the time are at rest.

    Parameters
    ----------
    found : Detection
        Without gaps.
    body : BodyModel
        The avatar whose facial actions they are.
    """
    rate = found.frame_rate
    seen = dict(zip(MEDIAPIPE, found.visibility.mean(axis=0), strict=True))
    joints = {name: _steadied(found.pose[:, place], rate) for place, name in enumerate(MEDIAPIPE)}
    joints["left_foot"], joints["right_foot"] = (
        joints["left_foot_index"], joints["right_foot_index"],
    )  # fmt: skip
    notes = []
    if min(seen[name] for name in LEGS) < _SEEN:
        joints = {name: at for name, at in joints.items() if not _is_of(name, _FEET)}
        joints = {name: at for name, at in joints.items() if not name.endswith("foot")}
    for side in ("left", "right"):
        if seen[f"{side}_elbow"] < _SEEN:
            joints = {name: at for name, at in joints.items()
                      if not (name.startswith(side) and _is_of(name, _HANDS))}  # fmt: skip
            notes.append(f"the {side} arm is out of the picture for most of the time: it hangs")
    poses, trans = rotations_from_joints(body_joints(joints, rate), REST_JOINTS, rate)
    clip = MotionClip(
        poses=poses.astype(np.float32),
        trans=trans.astype(np.float32),
        frame_rate=rate,
        arkit=facial_actions(landmark_shifts(found.face, rate, body), body, misfit=_MISFIT),
    )
    clip, moved = clear_of_body(clip)
    clip, _ = place(clip)
    said = "; ".join((*notes, *moved))
    return clip.with_provenance(notes=said) if said else clip


def _is_of(name: str, parts: tuple[str, ...]) -> bool:
    return name.partition("_")[2] in parts


def _steadied(points: FloatArray, frame_rate: float) -> FloatArray:
    """Return (T, 3) points without jitter."""
    width = round(frame_rate / _ANCHORS)
    bounds = np.arange(0, len(points), max(width, 1))
    if width < 2 or len(bounds) < 3:
        return points
    ends = np.append(bounds[1:], len(points))
    means = np.stack([points[a:b].mean(axis=0) for a, b in zip(bounds, ends, strict=True)])
    return np.asarray(CubicSpline((bounds + ends - 1) / 2, means, bc_type="natural")(
        np.arange(len(points))
    ))  # fmt: skip
