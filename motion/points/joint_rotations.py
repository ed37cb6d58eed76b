"""Joint rotations of a body from the joint positions of a person.

Every given bone gets its given direction and the body's own length. Rotations that positions do not
determine are chosen anatomically: upper arms and thighs are twisted so that elbows and knees bend
the way they can, the neck shares a turn of the head, the spine shares a turn of the shoulders, and
missing legs stand.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.body.skinning import share_forearm_twist, twist_angles
from motion.clip import MotionClip
from motion.errors import InputError
from motion.points.turning import frame_rotations, smallest_rotations
from motion.skeleton import (
    FINGER_NAMES,
    FINGERS,
    JOINT_COUNT,
    JOINT_NAMES,
    PARENTS,
    RELAXED_HANDS,
    joint_index,
)

LEGS: Final = ("left_knee", "right_knee", "left_ankle", "right_ankle")
"""Joints that determine the body's translation."""

_SIDES: Final = (("left", 1.0), ("right", -1.0))
_SPINE: Final = ("pelvis", "spine1", "spine2", "spine3", "neck")
_UNIT_AXES: Final = (np.array([1.0, 0, 0]), np.array([0, 1.0, 0]), np.array([0, 0, 1.0]))

_PELVIS_STAYS: Final = np.radians(45)
"""Turn of the shoulders beyond which missing hips follow."""

_STRAIGHT: Final = np.sin(np.radians(12))
"""Sine of an elbow's or knee's bend below which its plane hardly determines the twist."""

_PLANE_SMOOTHING: Final = 0.08
"""Standard deviation of the smoothing of a bend's plane, in seconds."""

_UPRIGHT: Final = 0.5
"""Share by which a head of unknown roll is straightened, from the neck's lean to the chest's."""

_MIN_LENGTH: Final = 1e-6
"""Smallest length of a bone that has a direction, in metres."""

_HANGING: Final = 78.0
"""Angle of missing arms below the rest pose, in degrees."""


class _Figure:
    """World rotations of joints, computed from the pelvis outwards."""

    def __init__(self, points: Mapping[str, Floats], rest: Floats, frame_rate: float) -> None:
        self.points = points
        self.rest = rest
        self.frame_rate = frame_rate
        self.frames = len(points["pelvis"])
        self.world: dict[str, Rotation] = {}

    def has(self, *names: str) -> bool:
        return all(name in self.points for name in names)

    def vector(self, start: str, end: str) -> Floats:
        """Return the vector from one joint to another in each frame, shape (T, 3)."""
        return self.points[end] - self.points[start]

    def rest_vector(self, start: str, end: str) -> Floats:
        """Return the vector from one joint to another at rest, shape (3,)."""
        return np.asarray(self.rest[joint_index(end)] - self.rest[joint_index(start)])

    def posed_vector(self, start: str, end: str) -> Floats:
        """Return the vector from a joint to its child in the current pose, shape (T, 3)."""
        return np.asarray(self.world[start].apply(self.rest_vector(start, end)))

    def swing(self, joint: str, end: str, start: Rotation) -> None:
        """Turn `joint` from rotation `start` by the smallest turn that makes it point at `end`."""
        self.world[joint] = start
        if self.has(joint, end):
            turn = smallest_rotations(self.posed_vector(joint, end), self.vector(joint, end))
            self.world[joint] = turn * self.world[joint]

    def locals(self) -> Floats:
        """Return rotation matrices relative to the parents, shape (T, 55, 3, 3)."""
        local = np.broadcast_to(np.eye(3), (self.frames, JOINT_COUNT, 3, 3)).copy()
        relaxed = Rotation.from_rotvec(RELAXED_HANDS.astype(float)).as_matrix()
        local[:, FINGERS] = relaxed
        for index, (joint, parent) in enumerate(zip(JOINT_NAMES, PARENTS, strict=True)):
            rotation = self.world.get(joint)
            if parent < 0 and rotation is not None:
                local[:, index] = rotation.as_matrix()
            elif rotation is not None:
                local[:, index] = (self.world[JOINT_NAMES[parent]].inv() * rotation).as_matrix()
        return local


def clip_from_joints(points: Mapping[str, Floats], rest: Floats, frame_rate: float) -> MotionClip:
    """Return the motion of a body whose bones have the given directions.

    Without legs, the body stands at the origin and its feet do not move.

    Parameters
    ----------
    points : mapping of str to ndarray, shape (T, 3)
        Positions of SMPL-X joints in metres, y up; at least pelvis, neck and both shoulders. Those
        of spine and collars are ignored. Any other joint counts only if its parent is given too.
    rest : ndarray, shape (55, 3)
        The joints of the body at rest, metres.
    frame_rate : float
        Frames per second.

    Raises
    ------
    InputError
        If a bone has no direction.
    """
    _check_directions(points)
    figure = _Figure(points, rest, frame_rate)
    heading = _heading(figure)
    _turn_trunk(figure, heading)
    _turn_head(figure)
    for side, sign in _SIDES:
        _turn_arm(figure, side, sign)
        _turn_hand(figure, side)
        _turn_leg(figure, side, heading)
    local = figure.locals()
    share_forearm_twist(local, None)
    poses = Rotation.from_matrix(local.reshape(-1, 3, 3)).as_rotvec()
    return MotionClip(
        poses=poses.reshape(-1, JOINT_COUNT, 3).astype(np.float32),
        trans=_translation(figure, heading).astype(np.float32),
        frame_rate=frame_rate,
    )


def _check_directions(points: Mapping[str, Floats]) -> None:
    """Raise `InputError` if a bone has no direction."""
    for start, end in _given_bones(points):
        lengths = np.linalg.norm(points[end] - points[start], axis=1)
        if lengths.min() < _MIN_LENGTH:
            raise InputError(
                f"{start} and {end} are one point in frame {int(lengths.argmin())}",
                remedy="Leave out frames in which joints were not found",
            )


def _given_bones(points: Mapping[str, Floats]) -> list[tuple[str, str]]:
    """Return the given bones: of the trunk, then each joint with its parent."""
    trunk = [("pelvis", "neck"), ("right_shoulder", "left_shoulder")]
    trunk += [("neck", f"{side}_shoulder") for side, _ in _SIDES]
    pairs = zip(PARENTS, JOINT_NAMES, strict=True)
    limbs = [(JOINT_NAMES[parent], joint) for parent, joint in pairs if parent >= 0]
    return trunk + [bone for bone in limbs if bone[0] in points and bone[1] in points]


def _heading(figure: _Figure) -> Rotation:
    """Return the rotation of the hips about the vertical."""
    if figure.has("left_hip", "right_hip"):
        return _about_y(_yaw(figure.vector("right_hip", "left_hip")))
    yaw = _yaw(figure.vector("right_shoulder", "left_shoulder"))
    deviations = yaw - yaw.mean()
    return _about_y(yaw.mean() + deviations - np.clip(deviations, -_PELVIS_STAYS, _PELVIS_STAYS))


def _yaw(across: Floats) -> Floats:
    return np.unwrap(np.arctan2(-across[:, 2], across[:, 0]))


def _about_y(angles: Floats) -> Rotation:
    return Rotation.from_rotvec(angles[:, None] * np.array([0, 1.0, 0]))


def _turn_trunk(figure: _Figure, heading: Rotation) -> None:
    """Turn pelvis and spine along the trunk, and between the turns of hips and shoulders."""
    if figure.has("left_hip", "right_hip"):
        hips = figure.vector("right_hip", "left_hip"), figure.rest_vector("right_hip", "left_hip")
    else:
        hips = heading.apply(_UNIT_AXES[0]), _UNIT_AXES[0]
    shoulders = "right_shoulder", "left_shoulder"
    rest_trunk, trunk = figure.rest_vector("pelvis", "neck"), figure.vector("pelvis", "neck")
    pelvis = frame_rotations((rest_trunk, hips[1]), (trunk, hips[0]))
    chest = frame_rotations(
        (rest_trunk, figure.rest_vector(*shoulders)), (trunk, figure.vector(*shoulders))
    )
    bend = (pelvis.inv() * chest).as_rotvec()
    for number, joint in enumerate(_SPINE[:-1]):
        figure.world[joint] = pelvis * Rotation.from_rotvec(bend * number / 3)
    posed_trunk = sum(figure.posed_vector(*bone) for bone in pairwise(_SPINE))
    turn = smallest_rotations(np.asarray(posed_trunk), trunk)
    for joint in _SPINE[:-1]:
        figure.world[joint] = turn * figure.world[joint]


def _turn_head(figure: _Figure) -> None:
    """Turn neck and head; each takes half of the head's turn about the neck."""
    top = "head" if figure.has("head") else "jaw"
    figure.swing("neck", top, figure.world["spine3"])
    neck = figure.world["neck"]
    figure.world["head"] = neck
    if not figure.has("head"):
        return
    if figure.has("left_eye", "right_eye", "jaw"):
        eyes = ("right_eye", "left_eye")
        figure.world["head"] = frame_rotations(
            (figure.rest_vector(*eyes), figure.rest_vector("head", "jaw")),
            (figure.vector(*eyes), figure.vector("head", "jaw")),
        )
    else:
        # A head that leans sideways is more upright than its neck: halfway back to the chest.
        lean = (neck.inv() * figure.world["spine3"]).as_rotvec()
        figure.swing("head", "jaw", neck * Rotation.from_rotvec(_UPRIGHT * lean))
    axis = figure.rest_vector("neck", "head")
    axis = axis / np.linalg.norm(axis)
    angles = twist_angles((neck.inv() * figure.world["head"]).as_quat(), axis)
    figure.world["neck"] = neck * Rotation.from_rotvec(angles[:, None] / 2 * axis)


def _turn_arm(figure: _Figure, side: str, sign: float) -> None:
    collar, shoulder, elbow, wrist = (
        f"{side}_{part}" for part in ("collar", "shoulder", "elbow", "wrist")
    )
    _turn_collar(figure, collar, shoulder)
    if figure.has(elbow):
        _turn_limb(figure, (shoulder, elbow, wrist), collar, _UNIT_AXES[2])
    else:
        down = Rotation.from_euler("z", -sign * _HANGING, degrees=True)
        figure.world[shoulder] = figure.world[elbow] = figure.world[collar] * down


def _turn_collar(figure: _Figure, collar: str, shoulder: str) -> None:
    """Turn a collar so that the shoulder has its given direction from the neck.

    The end of the collar is on a sphere around its start. It is placed where the line from the neck
    leaves that sphere or comes nearest to it.
    """
    chest = figure.world["spine3"]
    start = chest.apply(figure.rest_vector("neck", collar))
    length = np.linalg.norm(figure.rest_vector(collar, shoulder))
    line = figure.vector("neck", shoulder)
    line = line / np.linalg.norm(line, axis=1, keepdims=True)
    projections = (start * line).sum(axis=1)
    squared_distances = (start**2).sum(axis=1) - projections**2
    line_lengths = projections + np.sqrt(np.maximum(length**2 - squared_distances, 0))
    target = line_lengths[:, None] * line - start
    figure.world[collar] = (
        smallest_rotations(chest.apply(figure.rest_vector(collar, shoulder)), target) * chest
    )


def _turn_limb(figure: _Figure, limb: tuple[str, str, str], parent: str, bends: Floats) -> None:
    """Turn the two long bones of a limb, twisted so that the joint between them bends as it can.

    A nearly straight limb does not determine its twist; it keeps that of the smallest turn.
    """
    start, middle, end = limb
    figure.swing(start, middle, figure.world[parent])
    figure.world[middle] = figure.world[start]
    if not figure.has(start, middle, end):
        return
    axis = figure.vector(start, middle)
    axis = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    lower = figure.vector(middle, end)
    lower = lower / np.linalg.norm(lower, axis=1, keepdims=True)
    forwards = figure.world[start].apply(bends)
    forwards -= (forwards * axis).sum(axis=1, keepdims=True) * axis
    sideways = np.cross(axis, forwards)
    perpendicular = lower - (lower * axis).sum(axis=1, keepdims=True) * axis
    weight = np.linalg.norm(perpendicular, axis=1)
    plane = weight[:, None] * np.column_stack(
        [(perpendicular * forwards).sum(axis=1), (perpendicular * sideways).sum(axis=1)]
    )
    plane[:, 0] += _STRAIGHT**2
    plane = gaussian_filter1d(plane, _PLANE_SMOOTHING * figure.frame_rate, axis=0, mode="nearest")
    twist = np.arctan2(plane[:, 1], plane[:, 0])
    figure.world[start] = Rotation.from_rotvec(twist[:, None] * axis) * figure.world[start]
    figure.swing(middle, end, figure.world[start])


def _turn_hand(figure: _Figure, side: str) -> None:
    """Turn a hand and its given fingers; the others are relaxed."""
    wrist, middle, index = (f"{side}_{part}" for part in ("wrist", "middle1", "index1"))
    outer = next((f"{side}_{f}1" for f in ("ring", "pinky") if figure.has(f"{side}_{f}1")), None)
    figure.swing(wrist, middle, figure.world[f"{side}_elbow"])
    if outer is not None and figure.has(wrist, middle, index):
        figure.world[wrist] = frame_rotations(
            (figure.rest_vector(wrist, middle), figure.rest_vector(outer, index)),
            (figure.vector(wrist, middle), figure.vector(outer, index)),
        )
    for finger in FINGER_NAMES:
        chain = [f"{side}_{finger}{number}" for number in (1, 2, 3)]
        if figure.has(wrist, *chain):
            for (joint, end), parent in zip(pairwise(chain), (wrist, chain[0]), strict=True):
                figure.swing(joint, end, figure.world[parent])
            figure.world[chain[-1]] = figure.world[chain[-2]]


def _turn_leg(figure: _Figure, side: str, heading: Rotation) -> None:
    hip, knee, ankle, foot = (f"{side}_{part}" for part in ("hip", "knee", "ankle", "foot"))
    if figure.has(hip, *LEGS):
        _turn_limb(figure, (hip, knee, ankle), "pelvis", -_UNIT_AXES[2])
        figure.swing(ankle, foot, figure.world[knee])
    else:
        figure.world[hip] = heading


def _translation(figure: _Figure, heading: Rotation) -> Floats:
    if figure.has("left_hip", "right_hip", *LEGS):
        return np.asarray(figure.points["pelvis"] - figure.rest[0])
    hips = (
        figure.rest_vector("pelvis", "left_hip") + figure.rest_vector("pelvis", "right_hip")
    ) / 2
    return np.asarray(heading.apply(hips) - figure.world["pelvis"].apply(hips))
