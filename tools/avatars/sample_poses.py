"""A dozen poses and faces for checking how every avatar looks."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip, arkit_index
from motion.skeleton import JOINT_COUNT, joint_index

Turn = tuple[float, float, float]

_LOWERED: Final[Mapping[str, Turn]] = {"both_shoulder": (-1.18, 0, 0), "both_elbow": (0, -0.25, 0)}
_FINGERS: Final = ("index", "middle", "ring", "pinky")
FIST: Final = 1.5
"""Radians by which each joint of a finger is bent in a fist."""


@dataclass(frozen=True, kw_only=True)
class SamplePose:
    """One pose with its face.

    Attributes
    ----------
    turns : mapping of str to tuple
        Radians by joint about z, then the rotated y, then the rotated x; ``both_...`` is the left
        joint's, mirrored for the right. Arms that are not named hang at the sides.
    curled : mapping of str to float
        Radians by which all finger joints are bent, by ``left``, ``right``, ``left_index``, ...
    face : mapping of str to float
        ARKit weights by name; ``...Both`` is both sides.
    """

    turns: Mapping[str, Turn] = field(default_factory=dict)
    curled: Mapping[str, float] = field(default_factory=dict)
    face: Mapping[str, float] = field(default_factory=dict)


SAMPLE_POSES: Final[Mapping[str, SamplePose]] = MappingProxyType({
    "rest": SamplePose(curled={"left": 0.2, "right": 0.2}),
    "pointing": SamplePose(
        turns={"right_shoulder": (0.25, 1.2, 0), "right_elbow": (0, 0.15, 0),
               "right_thumb1": (0.2, 0.4, 0.4), "right_thumb2": (0.2, 0.6, 0)},
        curled={"right": 1.35, "right_index": 0.05, "left": 0.25},
    ),
    "fists": SamplePose(
        turns={"both_shoulder": (-1.05, -0.35, 0), "both_elbow": (0, -1.75, 0),
               "both_thumb1": (-0.5, -0.2, 0.4), "both_thumb2": (-0.3, -0.7, 0),
               "both_thumb3": (0, -0.8, 0)},
        curled={"left": FIST, "right": FIST},
    ),
    "arms crossed": SamplePose(
        turns={"left_shoulder": (-1.2, -0.60, 1.25), "left_elbow": (0, -1.70, 0),
               "right_shoulder": (1.2, 0.42, 1.35), "right_elbow": (0, 1.75, 0)},
        curled={"left": 0.35, "right": 0.3},
    ),
    "hands at the face": SamplePose(
        turns={"both_shoulder": (-0.95, -0.80, -0.2), "both_elbow": (0, -2.35, 0),
               "both_wrist": (0.2, 0, 0.3)},
        curled={"left": 0.25, "right": 0.25},
    ),
    "arms raised": SamplePose(turns={"both_shoulder": (0.95, 0, 0)}),
    "open palms": SamplePose(
        turns={"both_shoulder": (-1.05, 0.1, 0), "both_elbow": (0, -1.2, -1.5)},
        curled={"left": 0.12, "right": 0.12},
    ),
    "head turned": SamplePose(
        turns={"neck": (0, 0.35, 0), "head": (0.1, 0.5, 0.1), "spine3": (0, 0.15, 0)},
        curled={"left": 0.3, "right": 0.3},
    ),
    "laughing": SamplePose(
        turns={"head": (0.08, 0, -0.12)},
        curled={"left": 0.3, "right": 0.3},
        face={"mouthSmileBoth": 0.9, "jawOpen": 0.35, "cheekSquintBoth": 0.7,
              "eyeSquintBoth": 0.5, "mouthUpperUpBoth": 0.3, "browInnerUp": 0.2},
    ),
    "blinking": SamplePose(
        turns={"both_shoulder": (-1.25, 0, 0), "both_elbow": (0, -0.6, 0)},
        curled={"left": 0.5, "right": 0.5}, face={"eyeBlinkBoth": 1.0},
    ),
    "jaw open": SamplePose(turns={"jaw": (0, 0, 0.26)}, face={"eyeWideBoth": 0.5}),
    "eyes aside": SamplePose(
        turns={"left_eye": (0, 0.4, 0), "right_eye": (0, 0.4, 0)},
        face={"browDownBoth": 0.6, "mouthFrownBoth": 0.4},
    ),
})  # fmt: skip


def sample_clip(pose: SamplePose) -> MotionClip:
    """Return a clip of one frame that shows `pose`."""
    poses = np.zeros((1, JOINT_COUNT, 3), np.float32)
    for joint, turn in {**_both_sides(_LOWERED), **_both_sides(pose.turns)}.items():
        poses[0, joint_index(joint)] = Rotation.from_euler("ZYX", turn).as_rotvec()
    for name, bend in pose.curled.items():
        side, _, finger = name.partition("_")
        for each in (finger,) if finger else _FINGERS:
            for phalanx in (1, 2, 3):
                poses[0, joint_index(f"{side}_{each}{phalanx}")] = (
                    (0.0, 0.0, -bend) if side == "left" else (0.0, 0.0, bend)
                )
    return MotionClip(
        poses=poses, trans=np.zeros((1, 3), np.float32), frame_rate=30, arkit=_face(pose.face)
    )


def _both_sides(turns: Mapping[str, Turn]) -> dict[str, Turn]:
    """Return `turns` with each ``both_`` as left and its mirror image as right."""
    result: dict[str, Turn] = {}
    for joint, turn in turns.items():
        if joint.startswith("both_"):
            part = joint.removeprefix("both_")
            result[f"left_{part}"] = turn
            result[f"right_{part}"] = (-turn[0], -turn[1], turn[2])
        else:
            result[joint] = turn
    return result


def _face(face: Mapping[str, float]) -> NDArray[np.float32]:
    """Return the ARKit weights of one frame, shape (1, 52)."""
    weights = np.zeros((1, 52), np.float32)
    for name, weight in face.items():
        both = name.endswith("Both")
        stem = name.removesuffix("Both")
        for each in (f"{stem}Left", f"{stem}Right") if both else (name,):
            weights[0, arkit_index(each)] = weight
    return weights
