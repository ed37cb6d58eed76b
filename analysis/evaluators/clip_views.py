"""What a network sees of a clip, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from analysis.metrics.joint_positions import GESTURE_JOINTS
from motion.clip import MotionClip
from motion.errors import InputError
from motion.face_landmarks import FaceLandmarks
from motion.skeleton import JOINT_NAMES, joint_index

FloatArray = NDArray[np.float32]
Face = Literal["arkit", "expressions"]
Channels = Literal["body", "gesture", "expression", "both", "landmarks"]

_LEGS: Final = ("hip", "knee", "ankle", "foot")

AMUSE_JOINTS: Final = tuple(
    name for name in JOINT_NAMES if not any(name.endswith(f"_{part}") for part in _LEGS)
)
"""The 47 joints of AMUSE (Chhatre et al. 2024, section 3.1): all but the eight of the legs."""

_SMALLEST_TURN: Final = 0.01
"""Spread of a 6D rotation below which a joint counts as still; about half a degree."""

_SMALLEST_WEIGHT: Final = 0.02
"""Spread of a facial action or coefficient below which it counts as still."""

_SMALLEST_SHIFT: Final = 1e-4
"""Spread of a landmark's coordinate, in metres, below which it counts as still."""


class ClipView(Protocol):
    """What a network sees of a clip."""

    @property
    def channels(self) -> int:
        """How many numbers a frame has."""
        ...

    @property
    def floor(self) -> NDArray[np.float32]:
        """Spread of each channel below which it counts as still, shape (channels,)."""
        ...

    def frames(self, clip: MotionClip) -> FloatArray:
        """Return the clip's frames, shape (T, channels).

        Raises
        ------
        InputError
            If the clip does not hold what the network looks at.
        """
        ...

    def described(self) -> str:
        """Return what the channels are, in words."""
        ...


@dataclass(frozen=True)
class JointRotations:
    """Rotations of joints against their parents, as the first two columns of each matrix (6D).

    Zhou et al. 2019, "On the Continuity of Rotation Representations in Neural Networks".

    Attributes
    ----------
    joints : tuple of str
        SMPL-X names.
    """

    joints: tuple[str, ...]

    @property
    def channels(self) -> int:
        """Six for each joint."""
        return 6 * len(self.joints)

    @property
    def floor(self) -> NDArray[np.float32]:
        """About half a degree."""
        return np.full(self.channels, _SMALLEST_TURN, np.float32)

    def frames(self, clip: MotionClip) -> FloatArray:
        """Return the rotations, shape (T, 6 J)."""
        turns = clip.poses[:, [joint_index(name) for name in self.joints]]
        matrices = Rotation.from_rotvec(turns.reshape(-1, 3)).as_matrix()
        columns = np.swapaxes(matrices[:, :, :2], 1, 2)
        return columns.reshape(len(clip), self.channels).astype(np.float32)

    def described(self) -> str:
        """Say how many joints, and how they are told."""
        return f"{len(self.joints)} joints, 6D rotations against the parent joint"


@dataclass(frozen=True)
class FaceWeights:
    """A face as ARKit's 52 weights, or as the jaw's rotation and 100 SMPL-X coefficients.

    Attributes
    ----------
    face : {'arkit', 'expressions'}
        Which of the two.
    """

    face: Face

    @property
    def channels(self) -> int:
        """52, or 6 and 100."""
        return 52 if self.face == "arkit" else 106

    @property
    def floor(self) -> NDArray[np.float32]:
        """Two hundredths of a weight or coefficient, half a degree of the jaw."""
        still = np.full(self.channels, _SMALLEST_WEIGHT, np.float32)
        if self.face == "expressions":
            still[:6] = _SMALLEST_TURN
        return still

    def frames(self, clip: MotionClip) -> FloatArray:
        """Return the face, shape (T, 52) or (T, 106)."""
        if self.face == "arkit":
            return _required(clip.arkit, "ARKit weights")
        coefficients = _required(clip.expressions, "SMPL-X expression coefficients")
        jaw = JointRotations(("jaw",)).frames(clip)
        return np.concatenate([jaw, coefficients], axis=1)

    def described(self) -> str:
        """Say which face it is."""
        if self.face == "arkit":
            return "52 ARKit weights"
        return "the jaw's 6D rotation and 100 SMPL-X expression coefficients"


@dataclass(frozen=True)
class Together:
    """Several views at once.

    Attributes
    ----------
    parts : tuple of ClipView
        In the order of the channels.
    """

    parts: tuple[ClipView, ...]

    @property
    def channels(self) -> int:
        """Those of all parts."""
        return sum(part.channels for part in self.parts)

    @property
    def floor(self) -> NDArray[np.float32]:
        """That of each part."""
        return np.concatenate([part.floor for part in self.parts])

    def frames(self, clip: MotionClip) -> FloatArray:
        """Return the parts side by side."""
        return np.concatenate([part.frames(clip) for part in self.parts], axis=1)

    def described(self) -> str:
        """Say what each part is."""
        return "; ".join(part.described() for part in self.parts)


@dataclass(frozen=True, eq=False)
class LandmarkShifts:
    """How far each landmark of the face is from where it is in the neutral face, in metres.

    Attributes
    ----------
    landmarks : FaceLandmarks
        On which face.
    """

    landmarks: FaceLandmarks

    @property
    def channels(self) -> int:
        """Three for each landmark."""
        return 3 * self.landmarks.count

    @property
    def floor(self) -> NDArray[np.float32]:
        """A tenth of a millimetre."""
        return np.full(self.channels, _SMALLEST_SHIFT, np.float32)

    def frames(self, clip: MotionClip) -> FloatArray:
        """Return the shifts, shape (T, 3 L)."""
        return self.landmarks.shifts(clip).reshape(len(clip), self.channels)

    def described(self) -> str:
        """Say how many landmarks, and of what."""
        return f"{self.landmarks.count} face landmarks, metres from the neutral face"


def _required(values: FloatArray | None, what: str) -> FloatArray:
    if values is None:
        raise InputError(
            f"the clip holds no {what}, which the network was trained on",
            remedy="Use clips that hold them, or train a network on what these clips hold",
        )
    return values


JOINTS_OF_CHANNELS: Final = MappingProxyType[Channels, tuple[str, ...]](
    {
        "body": AMUSE_JOINTS,
        "gesture": GESTURE_JOINTS,
        "expression": (),
        "both": GESTURE_JOINTS,
        "landmarks": (),
    }
)
"""Joints whose rotations a network sees: AMUSE's, or everything above the pelvis except the face,
which is SMPL-X's counterpart of BEAT's 47 joints."""


def view_of(
    channels: Channels,
    *,
    joints: tuple[str, ...],
    face: Face | None = None,
    landmarks: FaceLandmarks | None = None,
) -> ClipView:
    """Return what a network that looks at `channels` sees of a clip.

    Parameters
    ----------
    channels : str
        ``body``, ``gesture``, ``expression``, ``both`` (gesture and expression) or ``landmarks``.
    joints : tuple of str
        SMPL-X names of the joints whose rotations it sees.
    face : {'arkit', 'expressions'}, optional
        In which terms it sees expressions.
    landmarks : FaceLandmarks, optional
        Where the landmarks are.

    Raises
    ------
    InputError
        If the channels need a face or landmarks and were given none.
    """
    if channels in ("body", "gesture"):
        return JointRotations(joints)
    if channels == "landmarks" and landmarks is not None:
        return LandmarkShifts(landmarks)
    if channels in ("expression", "both") and face is not None:
        expression = FaceWeights(face)
        return (
            expression
            if channels == "expression"
            else Together((JointRotations(joints), expression))
        )
    raise InputError(
        f"a network that looks at {channels!r} needs to know of which face",
        remedy="Use a file as 'motionjury train evaluator' wrote it",
    )


def face_of(clip: MotionClip) -> Face:
    """Return in which terms a clip tells the face; ARKit's where it does in both.

    Raises
    ------
    InputError
        If it tells nothing of the face.
    """
    if clip.arkit is not None:
        return "arkit"
    if clip.expressions is not None:
        return "expressions"
    raise InputError(
        "the clip tells nothing of the face",
        remedy="Give clips with ARKit weights or SMPL-X expression coefficients",
    )
