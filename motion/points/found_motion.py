"""A motion clip from the points detected in a stretch of video."""

from dataclasses import replace
from typing import Final

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial import KDTree

from motion.arrays import Floats, Floats32, Indices
from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.placement import clear_of_body, place
from motion.points.detection import Detection
from motion.points.joint_rotations import LEGS, clip_from_joints
from motion.points.person import MEDIAPIPE, body_joints
from motion.points.turning import nearest_similarity
from motion.skeleton import REST_JOINTS, joint_index

_RIGID_LANDMARKS: Final = (10, 151, 9, 168, 6, 197, 33, 133, 362, 263, 127, 356, 234, 454)
"""Points of forehead, bridge of the nose, corners of the eyes and temples, which expressions hardly
move."""

_LIDS: Final = {
    "left": ((386, 374), (263, 362)),
    "right": ((159, 145), (33, 133)),
}
"""Middles of the upper and lower lid, and corners, of each of the person's eyes."""

_LIPS: Final = (13, 14)
_NOSE_TIP: Final = 1
_MOUTH: Final = {"left": 291, "right": 61}

_FRONT_OF_EYE: Final = 0.012
"""Distance from the middle of an eye to its front, in metres."""

_NEUTRAL_PERCENTILE: Final = 25
"""Percentage of the frames, those with the most closed mouth, that may show the neutral face."""

_SMOOTHING: Final = 0.03
"""Standard deviation of the smoothing of a detected face, in seconds."""


def _landmark_shifts(
    mesh: Floats, frame_rate: float, body: BodyModel, landmarks: FaceLandmarks
) -> Floats32:
    """Return the shifts of the body's landmarks (T, L, 3) for a detected face (T, 478, 3).

    Each landmark follows the point of the person's neutral face at its position after aligning
    eyes, nose and corners of the mouth of both faces.
    """
    upright = mesh * [1, -1, -1]
    rigid = list(_RIGID_LANDMARKS)
    first = nearest_similarity(upright[:, rigid], upright[0, rigid]).apply(upright)
    typical = np.median(first, axis=0)
    aligned = nearest_similarity(upright[:, rigid], typical[rigid]).apply(upright)
    aligned = gaussian_filter1d(aligned, _SMOOTHING * frame_rate, axis=0, mode="nearest")
    neutral = aligned[_neutral_frames(aligned)].mean(axis=0)
    anchors = np.stack([_eye(neutral, "left"), _eye(neutral, "right"), neutral[_NOSE_TIP],
                    neutral[_MOUTH["left"]], neutral[_MOUTH["right"]]])  # fmt: skip
    fit = nearest_similarity(anchors[None], _anchors(body))
    onto = fit.apply(neutral[None])[0]
    _, nearest = KDTree(onto[:, :2]).query(landmarks.neutral[:, :2])
    shifts = fit.scales[0] * fit.turns[0].apply((aligned - neutral)[:, nearest].reshape(-1, 3))
    return np.asarray(shifts.reshape(len(mesh), landmarks.count, 3), np.float32)


def _eye(face: Floats, side: str) -> Floats:
    """Return the middle of an eye between its corners."""
    return np.asarray(face[list(_LIDS[side][1])].mean(axis=0))


def _neutral_frames(aligned: Floats) -> Indices:
    """Return the frames of a neutral face: open eyes and the most closed mouth."""
    mouth = np.linalg.norm(aligned[:, _LIPS[0]] - aligned[:, _LIPS[1]], axis=1)
    lids = [np.linalg.norm(aligned[:, above] - aligned[:, below], axis=1)
            for (above, below), _ in _LIDS.values()]  # fmt: skip
    opened = np.min(lids, axis=0)
    awake = np.flatnonzero(opened >= np.median(opened))
    is_closed = mouth[awake] <= np.percentile(mouth[awake], _NEUTRAL_PERCENTILE)
    return np.asarray(awake[is_closed])


def _anchors(body: BodyModel) -> Floats:
    """Return eyes, tip of the nose and corners of the mouth of the body, shape (5, 3)."""
    joints = body.joints(np.zeros(0))
    eyes = [
        joints[joint_index(f"{side}_eye")] + [0, 0, _FRONT_OF_EYE] for side in ("left", "right")
    ]
    names = [str(name) for name in body.surface["material_names"]]
    skin, lips = (body.template[body.surface["material"] == names.index(name)]
                  for name in ("skin", "lips"))  # fmt: skip
    head = skin[skin[:, 1] > joints[joint_index("neck"), 1]]
    nose = head[head[:, 2].argmax()]
    corners = lips[lips[:, 0].argmax()], lips[lips[:, 0].argmin()]
    return np.stack([*eyes, nose, *corners]).astype(float)


_KNOTS_PER_SECOND: Final = 5.0
"""Points in time around which detections are averaged, with smooth motion between them, to remove
jitter (Bhattacharya et al. 2024, section 4)."""

_MISFIT: Final = 6e-3
"""Error of a detected face in metres, see `FaceLandmarks.facial_actions`."""

_MIN_VISIBILITY: Final = 0.5
"""Smallest mean visibility of a joint that counts."""

_FEET: Final = ("heel", "foot_index", "ankle", "knee")
_HANDS: Final = ("elbow", "wrist", "pinky", "index", "thumb")


def clip_from_detection(detection: Detection, body: BodyModel) -> MotionClip:
    """Return the motion of a person in a stretch of video, with the face as facial actions.

    Arms or legs that are out of the picture most of the time are at rest.

    Parameters
    ----------
    detection : Detection
        The detected points, without gaps.
    body : BodyModel
        The avatar with the facial actions.
    """
    rate = detection.frame_rate
    visibility = dict(zip(MEDIAPIPE, detection.visibility.mean(axis=0), strict=True))
    joints = {name: _smoothed(detection.pose[:, k], rate) for k, name in enumerate(MEDIAPIPE)}
    joints["left_foot"], joints["right_foot"] = (
        joints["left_foot_index"], joints["right_foot_index"],
    )  # fmt: skip
    notes = []
    if min(visibility[name] for name in LEGS) < _MIN_VISIBILITY:
        joints = {name: at for name, at in joints.items() if not _is_of(name, _FEET)}
        joints = {name: at for name, at in joints.items() if not name.endswith("foot")}
    for side in ("left", "right"):
        if visibility[f"{side}_elbow"] < _MIN_VISIBILITY:
            joints = {name: at for name, at in joints.items()
                      if not (name.startswith(side) and _is_of(name, _HANDS))}  # fmt: skip
            notes.append(f"the {side} arm is out of the picture for most of the time: it hangs")
    landmarks = FaceLandmarks.of(body)
    shifts = _landmark_shifts(detection.face, rate, body, landmarks)
    clip = replace(
        clip_from_joints(body_joints(joints, rate), REST_JOINTS, rate),
        arkit=landmarks.facial_actions(shifts, misfit=_MISFIT),
    )
    clip, clearance_notes = clear_of_body(clip)
    clip, _ = place(clip)
    note = "; ".join((*notes, *clearance_notes))
    return clip.with_provenance(notes=note) if note else clip


def _is_of(name: str, parts: tuple[str, ...]) -> bool:
    return name.partition("_")[2] in parts


def _smoothed(points: Floats, frame_rate: float) -> Floats:
    """Return (T, 3) points without jitter."""
    width = round(frame_rate / _KNOTS_PER_SECOND)
    bounds = np.arange(0, len(points), max(width, 1))
    if width < 2 or len(bounds) < 3:
        return points
    ends = np.append(bounds[1:], len(points))
    means = np.stack([points[a:b].mean(axis=0) for a, b in zip(bounds, ends, strict=True)])
    return np.asarray(CubicSpline((bounds + ends - 1) / 2, means, bc_type="natural")(
        np.arange(len(points))
    ))  # fmt: skip
