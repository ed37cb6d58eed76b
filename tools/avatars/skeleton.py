"""The skeleton: a bone from each joint to its parent, a ball at each joint, a head.

It has no skin and no face; a nose shows its direction.
"""

from typing import Final

import numpy as np
import trimesh
from numpy.typing import NDArray

from motion.clip import ARKIT_NAMES
from motion.skeleton import FACE_JOINTS, JOINT_COUNT, JOINT_NAMES, PARENTS, joint_index
from tools.avatars.pieces import Piece
from tools.avatars.sitter import Sitter

Array = NDArray[np.float64]

_BONE: Final = 0.015
_BALL: Final = 0.024
_FINGER_BONE: Final = 0.0065
_FINGER_BALL: Final = 0.0085
_FINGER_TIP: Final = 0.8
"""Length of a finger's last part as a share of the previous one."""

_HEAD: Final = ((0.0, 0.05, 0.012), (0.072, 0.115, 0.092))
_NOSE: Final = ((0.0, 0.032, 0.105), (0.013, 0.018, 0.016))
"""Centre, from the head joint, and half axes in metres."""

_TOES: Final = 0.07
_HEEL: Final = 0.035


def skeleton(sitter: Sitter) -> list[Piece]:
    """Return all pieces of the skeleton, placed at the sitter's joints."""
    shown = [k for k, name in enumerate(JOINT_NAMES) if name not in FACE_JOINTS]
    bones = [
        _bone(sitter.joints[PARENTS[joint]], sitter.joints[joint], joint, PARENTS[joint])
        for joint in shown
        if PARENTS[joint] >= 0
    ]
    balls = [_ball(sitter.joints[joint], joint) for joint in shown if JOINT_NAMES[joint] != "head"]
    return [*bones, *balls, *_tips(sitter), *_feet(sitter), *_head(sitter)]


def _tips(sitter: Sitter) -> list[Piece]:
    """Return the last part of each finger, beyond its last joint."""
    pieces = []
    for last in (k for k, name in enumerate(JOINT_NAMES) if name.endswith("3") and _is_finger(k)):
        end = sitter.joints[last]
        tip = end + _FINGER_TIP * (end - sitter.joints[PARENTS[last]])
        pieces.append(_bone(end, tip, last, last))
    return pieces


def _feet(sitter: Sitter) -> list[Piece]:
    """Return heels and toes, which reach the ground when a foot stands on it."""
    pieces = []
    for side in ("left", "right"):
        ankle, foot = joint_index(f"{side}_ankle"), joint_index(f"{side}_foot")
        at, front = sitter.joints[ankle], sitter.joints[foot]
        heel = np.array([at[0], front[1], at[2] - _HEEL])
        pieces += [
            _bone(at, heel, foot, ankle),
            _bone(heel, front, foot, ankle),
            _bone(front, front + np.array([0.0, 0.0, _TOES]), foot, foot),
        ]
    return pieces


def _head(sitter: Sitter) -> list[Piece]:
    """Return the head and its nose."""
    pieces = []
    for (centre, half), subdivisions in ((_HEAD, 3), (_NOSE, 2)):
        mesh = trimesh.creation.icosphere(subdivisions=subdivisions, radius=1.0)
        vertices = mesh.vertices * half + np.array(centre) + sitter.joint("head")
        pieces.append(_piece(vertices, mesh.faces, "head", joint_index("head")))
    return pieces


def _bone(start: Array, end: Array, joint: int, moved_by: int) -> Piece:
    """Return a bone with round ends, of the size for `joint`."""
    fine = _is_finger(joint)
    length = float(np.linalg.norm(end - start))
    mesh = trimesh.creation.capsule(
        height=length,
        radius=_FINGER_BONE if fine else _BONE,
        count=(4, 8) if fine else (4, 12),
    )
    turn = trimesh.geometry.align_vectors([0, 0, 1], (end - start) / length)  # type: ignore[no-untyped-call]
    mesh.apply_transform(turn)
    return _piece(mesh.vertices + (start + end) / 2, mesh.faces, JOINT_NAMES[joint], moved_by)


def _ball(centre: Array, joint: int) -> Piece:
    fine = _is_finger(joint)
    mesh = trimesh.creation.icosphere(
        subdivisions=1 if fine else 2, radius=_FINGER_BALL if fine else _BALL
    )
    return _piece(mesh.vertices + centre, mesh.faces, JOINT_NAMES[joint], joint)


def _is_finger(joint: int) -> bool:
    name = JOINT_NAMES[joint]
    return name[-1].isdigit() and "spine" not in name


def _piece(vertices: Array, faces: NDArray[np.integer], name: str, moved_by: int) -> Piece:
    """Return a rigid piece in the colour of the side of joint `name`."""
    side = name.split("_")[0]
    weights = np.zeros((len(vertices), JOINT_COUNT))
    weights[:, moved_by] = 1.0
    return Piece(
        material=f"{side} bone" if side in ("left", "right") else "bone",
        vertices=np.asarray(vertices, float),
        faces=np.asarray(faces, np.int64),
        weights=weights,
        actions=np.zeros((len(ARKIT_NAMES), len(vertices), 3)),
    )
