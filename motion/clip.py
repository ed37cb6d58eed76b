"""A motion clip: the motion of one body and face over time, as SMPL-X parameters.

A study can freeze channels of all its clips, so that a channel that a condition lacks does not
give the condition away.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Final, Self

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats32
from motion.errors import InputError
from motion.skeleton import (
    FACE_JOINTS,
    FINGERS,
    JOINT_COUNT,
    LEFT_HAND_JOINTS,
    RELAXED_HANDS,
    RIGHT_HAND_JOINTS,
    joint_index,
)

ARKIT_NAMES: Final = (
    "browDownLeft", "browDownRight", "browInnerUp", "browOuterUpLeft", "browOuterUpRight",
    "cheekPuff", "cheekSquintLeft", "cheekSquintRight", "eyeBlinkLeft", "eyeBlinkRight",
    "eyeLookDownLeft", "eyeLookDownRight", "eyeLookInLeft", "eyeLookInRight", "eyeLookOutLeft",
    "eyeLookOutRight", "eyeLookUpLeft", "eyeLookUpRight", "eyeSquintLeft", "eyeSquintRight",
    "eyeWideLeft", "eyeWideRight", "jawForward", "jawLeft", "jawOpen", "jawRight", "mouthClose",
    "mouthDimpleLeft", "mouthDimpleRight", "mouthFrownLeft", "mouthFrownRight", "mouthFunnel",
    "mouthLeft", "mouthLowerDownLeft", "mouthLowerDownRight", "mouthPressLeft",
    "mouthPressRight", "mouthPucker", "mouthRight", "mouthRollLower", "mouthRollUpper",
    "mouthShrugLower", "mouthShrugUpper", "mouthSmileLeft", "mouthSmileRight",
    "mouthStretchLeft", "mouthStretchRight", "mouthUpperUpLeft", "mouthUpperUpRight",
    "noseSneerLeft", "noseSneerRight", "tongueOut",
)  # fmt: skip
"""The 52 facial actions of Apple's ARKit, in the order in which clips hold them."""

ARKIT_COUNT: Final = len(ARKIT_NAMES)
EXPRESSION_COUNT: Final = 100
GENDERS: Final = ("neutral", "female", "male")
MIN_FRAME_RATE: Final = 1.0
MAX_FRAME_RATE: Final = 1000.0
LARGEST_VALUE: Final = 1e6
"""Far beyond any position in metres or any coefficient; larger numbers are damage."""

LARGEST_ROTATION: Final = 10 * np.pi
"""Far beyond any joint's rotation in radians; arms that hang down exceed it in degrees."""


def arkit_index(name: str) -> int:
    """Return the index of facial action `name` in `ARKIT_NAMES`."""
    return ARKIT_NAMES.index(name)


def check_frame_rate(frame_rate: float) -> None:
    """Raise `InputError` unless `frame_rate` is from 1 to 1000 frames per second."""
    if not MIN_FRAME_RATE <= frame_rate <= MAX_FRAME_RATE:
        raise InputError(
            f"frame rate {frame_rate:g} is not usable",
            remedy=f"Give frames per second from {MIN_FRAME_RATE:.0f} to {MAX_FRAME_RATE:.0f}",
        )


@dataclass(frozen=True, kw_only=True)
class MotionClip:
    """One motion clip; its shapes, values and frame rate are checked when it is made.

    Attributes
    ----------
    poses : ndarray, shape (T, 55, 3), float32
        Rotation of each SMPL-X joint relative to its parent, axis-angle in radians, in the
        order of `motion.skeleton.JOINT_NAMES`. Files hold it as (T, 165).
    trans : ndarray, shape (T, 3), float32
        Translation of the body in metres; y is up.
    frame_rate : float
        Frames per second, ``1 <= frame_rate <= 1000``.
    betas : ndarray, shape (B,), float32
        SMPL-X shape coefficients; empty for the model's mean shape.
    expressions : ndarray, shape (T, 100), float32, or None
        SMPL-X expression coefficients.
    arkit : ndarray, shape (T, 52), float32, or None
        ARKit blendshape weights in [0, 1], in the order of `motion.clip.ARKIT_NAMES`.
    gender : str
        ``neutral``, ``female`` or ``male``: which SMPL-X template the betas belong to.
    provenance : mapping of str to str
        The clip's origin: generator, seed, source file, and changes.

    Raises
    ------
    InputError
        If a shape, value or the frame rate is not as stated.
    """

    poses: Floats32
    trans: Floats32
    frame_rate: float
    betas: Floats32 = field(default_factory=lambda: np.zeros(0, np.float32))
    expressions: Floats32 | None = None
    arkit: Floats32 | None = None
    gender: str = "neutral"
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        frames = len(self.poses)
        if frames == 0:
            raise InputError("the motion has no frame", remedy="Give at least one frame")
        check_frame_rate(self.frame_rate)
        self._adopt("poses", (frames, JOINT_COUNT, 3))
        self._adopt("trans", (frames, 3))
        self._adopt("betas", (np.size(self.betas),))
        if self.expressions is not None:
            self._adopt("expressions", (frames, EXPRESSION_COUNT))
        if self.arkit is not None:
            self._adopt("arkit", (frames, ARKIT_COUNT))
            if self.arkit.min() < -1e-6 or self.arkit.max() > 1 + 1e-6:
                raise InputError(
                    f"arkit weights lie in [{self.arkit.min():.3g}, {self.arkit.max():.3g}]",
                    remedy="Scale the blendshape weights to [0, 1]",
                )
        if self.gender not in GENDERS:
            raise InputError(
                f"unknown gender {self.gender!r}", remedy=f"Use one of {', '.join(GENDERS)}"
            )
        object.__setattr__(self, "frame_rate", float(self.frame_rate))
        object.__setattr__(self, "provenance", MappingProxyType(dict(self.provenance)))

    def _adopt(self, name: str, shape: tuple[int, ...]) -> None:
        """Keep field `name` as a read-only, finite float32 array of `shape`."""
        values = np.asarray(getattr(self, name))
        if values.shape != shape:
            raise InputError(
                f"{name} has shape {values.shape}, expected {shape}",
                remedy="Give every array of the clip one row per frame and the expected width",
            )
        largest = LARGEST_ROTATION if name == "poses" else LARGEST_VALUE
        usable = np.abs(values) <= np.float64(largest)
        if not usable.all():
            index = tuple(map(int, np.argwhere(~usable)[0]))
            raise InputError(
                f"{name} holds {values[index]:.3g} at index {index}",
                remedy="Give finite radians (not degrees), metres and coefficients; repair or cut "
                "damaged frames",
            )
        array = np.array(values, dtype=np.float32)
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.poses)

    @property
    def duration(self) -> float:
        """Length in seconds: each frame stands for one frame interval."""
        return len(self) / self.frame_rate

    @property
    def faces(self) -> dict[str, Any]:
        """Those of the arrays `expressions` and `arkit` that the clip has, by name."""
        faces = {"expressions": self.expressions, "arkit": self.arkit}
        return {name: face for name, face in faces.items() if face is not None}

    def frames(self, index: slice | NDArray[np.int_]) -> Self:
        """Return a clip of the frames that `index` selects, in that order."""
        faces = {name: face[index] for name, face in self.faces.items()}
        return replace(self, poses=self.poses[index], trans=self.trans[index], **faces)

    def with_provenance(self, **facts: str) -> Self:
        """Return the clip with `facts` added to its provenance."""
        return replace(self, provenance={**self.provenance, **facts})


_LEGS: Final = ("hip", "knee", "ankle", "foot")
_JOINTS_OF_CHANNEL: Final = MappingProxyType(
    {
        "face": FACE_JOINTS,
        "hands": (*LEFT_HAND_JOINTS, *RIGHT_HAND_JOINTS),
        "lower_body": tuple(f"{side}_{part}" for part in _LEGS for side in ("left", "right")),
        "root": ("pelvis",),
    }
)
CHANNELS: Final = tuple(_JOINTS_OF_CHANNEL)

_VISIBLE_TURN: Final = 0.02
"""Smallest visible turn of a joint, in radians."""

_VISIBLE_SHIFT: Final = 0.005
"""Smallest visible movement of the root, in metres."""

_VISIBLE_EXPRESSION: Final = 0.05
"""Smallest visible change of a facial action's weight or an expression's coefficient."""


def freeze(clip: MotionClip, channels: Collection[str]) -> MotionClip:
    """Return `clip` with `channels` held at neutral values in every frame.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    channels : collection of str
        Any of `CHANNELS`. ``face``: jaw, eyes, expressions and ARKit weights are zero.
        ``hands``: fingers are relaxed. ``lower_body``: legs are straight. ``root``:
        the pelvis stays at the origin and faces +z.
    """
    poses = clip.poses.copy()
    for channel in channels:
        poses[:, [joint_index(name) for name in _JOINTS_OF_CHANNEL[channel]]] = 0
    if "hands" in channels:
        poses[:, FINGERS] = RELAXED_HANDS
    frozen = replace(clip, poses=poses)
    if "root" in channels:
        frozen = replace(frozen, trans=np.zeros_like(clip.trans))
    if "face" in channels:
        still = {name: np.zeros_like(face) for name, face in clip.faces.items()}
        frozen = replace(frozen, **still)
    return frozen


def moving_channels(clip: MotionClip) -> frozenset[str]:
    """Return the channels of `clip` that move visibly."""
    changes = {}
    for name, joints in _JOINTS_OF_CHANNEL.items():
        turns = np.ptp(clip.poses[:, [joint_index(joint) for joint in joints]], axis=0)
        changes[name] = [turns > _VISIBLE_TURN]
    changes["root"].append(np.ptp(clip.trans, axis=0) > _VISIBLE_SHIFT)
    faces = clip.faces.values()
    changes["face"].extend(np.ptp(face, axis=0) > _VISIBLE_EXPRESSION for face in faces)
    return frozenset(name for name, parts in changes.items() if any(part.any() for part in parts))
