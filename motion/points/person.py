"""Converting joints of another skeleton, or detected points, to joints of our body.

Skeletons differ in build, such as the height of the neck between the shoulders and the position of
the head. Their average pose is equated with our body's rest pose, so that nobody shrugs or looks
down for a whole recording.
"""

from collections.abc import Mapping
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.errors import InputError
from motion.points.turning import frame_rotations, front_views, smallest_rotations
from motion.skeleton import JOINT_NAMES, REST_JOINTS, joint_index

Points = Mapping[str, Floats]

MEDIAPIPE: Final = (
    "nose", "left_eye_inner", "left_eye", "left_eye_outer", "right_eye_inner", "right_eye",
    "right_eye_outer", "left_ear", "right_ear", "mouth_left", "mouth_right", "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_pinky",
    "right_pinky", "left_index", "right_index", "left_thumb", "right_thumb", "left_hip",
    "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle", "left_heel", "right_heel",
    "left_foot_index", "right_foot_index",
)  # fmt: skip
"""Landmarks of MediaPipe's (BlazePose's) pose, in order."""

_EARS: Final = ("left_ear", "right_ear")
_SHOULDERS: Final = ("left_shoulder", "right_shoulder")
_HIPS: Final = ("left_hip", "right_hip")
_HEAD: Final = ("head", "jaw", "left_eye", "right_eye")
_NO_ARM: Final = ("hip", "knee", "ankle", "foot", "ear", "eye")
_COMPUTED: Final = tuple(joint for joint in JOINT_NAMES if "spine" in joint or "collar" in joint)
"""Joints whose positions differ between skeletons; they are ignored, and trunk and shoulders follow
the other joints."""

_EARS_TO_HEAD: Final = np.array([0, -0.2, 1.0])
_TO_CROWN: Final = np.array([0, 0.278, 0.02])
_TO_NOSE: Final = np.array([0, 0.866, 0.434])
"""Directions in an upright head: from between the ears to the nose, and from the neck to crown and
nose, the latter as in TED Gesture's mean pose."""

_KNUCKLES: Final = 0.59
"""Position of the middle finger's knuckle between the little and the index finger's."""

_MIN_LENGTH: Final = 1e-6


def body_joints(points: Points, frame_rate: float) -> dict[str, Floats]:
    """Return positions of SMPL-X joints in metres, y up; from a camera, facing +z on average.

    Parameters
    ----------
    points : mapping of str to ndarray, shape (T, 3)
        Positions by SMPL-X name, in any unit and with any axis up. Also `nose`, `left_ear`,
        `right_ear`, `crown`, and the knuckles `left_index`, `left_pinky`, `right_index` and
        `right_pinky`. At least both shoulders, and the pelvis or both hips.
    frame_rate : float
        Frames per second.

    Raises
    ------
    InputError
        If the trunk is missing, or has no extent.
    """
    joints = {name: values for name, values in points.items() if name not in _COMPUTED}
    _check_trunk(joints)
    seen_by_camera = "left_ear" in joints
    if "pelvis" not in joints:
        joints["pelvis"] = _middle(joints, _HIPS)
    joints = _upright(joints, frame_rate, seen_by_camera=seen_by_camera)
    chest = _chest(joints)
    if "neck" not in joints:
        joints["neck"] = _middle(joints, _SHOULDERS) + chest.apply(_at_rest("neck") - _rest_top())
    for side in ("left", "right"):
        _place_knuckles(joints, side)
        arm = [name for name in joints if name.startswith(side) and _part(name) not in _NO_ARM]
        _turn_to(joints, chest, f"{side}_shoulder", arm)
    _place_head(joints, chest)
    return {name: values for name, values in joints.items() if name in JOINT_NAMES}


def _check_trunk(points: Points) -> None:
    missing = [name for name in _SHOULDERS if name not in points]
    if "pelvis" not in points and not all(name in points for name in _HIPS):
        missing.append("pelvis")
    if missing:
        raise InputError(
            f"the joints lack {', '.join(missing)}; they are {', '.join(sorted(points)) or 'none'}",
            remedy="Name both shoulders and the pelvis, or both hips, as SMPL-X does (--joints "
            "says which is which)",
        )
    across = points[_SHOULDERS[0]] - points[_SHOULDERS[1]]
    if np.linalg.norm(across, axis=1).min() < _MIN_LENGTH:
        frame = int(np.linalg.norm(across, axis=1).argmin())
        raise InputError(
            f"both shoulders are one point in frame {frame}",
            remedy="Leave out frames in which nobody was found",
        )


def _upright(
    points: dict[str, Floats], frame_rate: float, *, seen_by_camera: bool
) -> dict[str, Floats]:
    """Return the points scaled to our body, y up, and from the front if a camera saw them."""
    trunk = [points[name] for name in ("pelvis", *_SHOULDERS)]
    up = np.median((trunk[1] + trunk[2]) / 2 - trunk[0], axis=0)
    size = float(np.linalg.norm(_rest_top() - _at_rest("pelvis")))
    size /= max(float(np.linalg.norm(up)), _MIN_LENGTH)
    if seen_by_camera:
        places = list(_SHOULDERS) + (list(_HIPS) if _HIPS[0] in points else ["pelvis"])
        turn = front_views(
            np.stack([points[name] for name in places], axis=1),
            np.stack([_at_rest(name) for name in places]),
            frame_rate,
        )
    else:
        axis = np.where(np.arange(3) == np.abs(up).argmax(), np.sign(up), 0)
        turn = smallest_rotations(axis[None], np.array([[0, 1.0, 0]]))
    return {name: size * turn.apply(values) for name, values in points.items()}


def _chest(points: Points) -> Rotation:
    """Return the rotation of the chest, from hips and shoulders."""
    across = _at_rest(_SHOULDERS[0]) - _at_rest(_SHOULDERS[1])
    return frame_rotations(
        (_rest_top() - _at_rest("pelvis"), across),
        (
            _middle(points, _SHOULDERS) - points["pelvis"],
            points[_SHOULDERS[0]] - points[_SHOULDERS[1]],
        ),
    )


def _turn_to(points: dict[str, Floats], chest: Rotation, end: str, others: list[str]) -> None:
    """Turn the bone from the neck to `end` so that on average it points as at rest.

    The points `others` move with its end.
    """
    bone = points[end] - points["neck"]
    mean_bone = np.median(chest.inv().apply(bone), axis=0)
    if np.linalg.norm(mean_bone) < _MIN_LENGTH:
        raise InputError(f"neck and {end} are one point", remedy="Check the names of the joints")
    turn = smallest_rotations(mean_bone[None], (_at_rest(end) - _at_rest("neck"))[None])
    settled = chest.apply(turn.apply(chest.inv().apply(bone)))
    for name in others:
        points[name] = points[name] + settled - bone


def _part(name: str) -> str:
    return name.partition("_")[2]


def _place_head(points: dict[str, Floats], chest: Rotation) -> None:
    """Place head, jaw and eyes as on our body, by the known part of the head's rotation."""
    neck = points["neck"]
    if "nose" in points and all(ear in points for ear in _EARS):
        ears = points[_EARS[0]] - points[_EARS[1]]
        middle = _middle(points, _EARS)
        rotation = frame_rotations(
            (np.array([1.0, 0, 0]), _EARS_TO_HEAD), (ears, points["nose"] - middle)
        )
        points["head"] = middle
    elif "nose" in points and "crown" in points:
        rotation = frame_rotations(
            (_TO_CROWN, _TO_NOSE), (points["crown"] - neck, points["nose"] - neck)
        )
        points["head"] = neck + rotation.apply(_at_rest("head") - _at_rest("neck"))
    else:
        if "nose" in points:
            points.setdefault("jaw", points["nose"])
        if "head" in points:
            _turn_to(points, chest, "head", [name for name in _HEAD if name in points])
        return
    _turn_to(points, chest, "head", ["head"])
    nod = np.median((chest.inv() * rotation).as_rotvec()[:, 0])
    rotation = rotation * Rotation.from_rotvec([-nod, 0, 0])
    for name in _HEAD[1:]:
        points[name] = points["head"] + rotation.apply(_at_rest(name) - _at_rest("head"))


def _place_knuckles(points: dict[str, Floats], side: str) -> None:
    """Turn a detector's knuckles into joints."""
    index, pinky = points.get(f"{side}_index"), points.get(f"{side}_pinky")
    if index is not None and pinky is not None:
        points[f"{side}_index1"], points[f"{side}_pinky1"] = index, pinky
        points[f"{side}_middle1"] = pinky + _KNUCKLES * (index - pinky)


def _middle(points: Points, names: tuple[str, str]) -> Floats:
    return (points[names[0]] + points[names[1]]) / 2


def _rest_top() -> Floats:
    return np.asarray((_at_rest(_SHOULDERS[0]) + _at_rest(_SHOULDERS[1])) / 2)


def _at_rest(name: str) -> Floats:
    return np.asarray(REST_JOINTS[joint_index(name)])
