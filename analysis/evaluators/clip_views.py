"""The input of a feature network: channels of a clip's frames, cut into windows."""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Literal

import numpy as np
from scipy.spatial.transform import Rotation

from analysis.metrics.kinematics import GESTURE_JOINTS
from motion.arrays import Floats32
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_NAMES, joint_index

Face = Literal["arkit", "expressions"]
Channels = Literal["body", "gesture", "expression", "both", "landmarks"]

_FACES: Final = MappingProxyType[Face, str](
    {"arkit": "ARKit weights", "expressions": "SMPL-X expression coefficients"}
)

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


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipView:
    """The channels of a clip that a network sees, side by side.

    Attributes
    ----------
    joints : tuple of str
        SMPL-X names of joints whose rotations relative to their parents are used, as the first two
        columns of each matrix (6D; Zhou et al. 2019, "On the Continuity of Rotation Representations
        in Neural Networks").
    face : {'arkit', 'expressions'} or None
        A face as ARKit's 52 weights, or as the jaw's rotation and 100 SMPL-X coefficients.
    landmarks : FaceLandmarks or None
        Displacement of each face landmark from the neutral face, in metres.
    """

    joints: tuple[str, ...] = ()
    face: Face | None = None
    landmarks: FaceLandmarks | None = None

    @property
    def channels(self) -> int:
        """Number of channels of a frame."""
        return len(self.floor)

    @property
    def floor(self) -> Floats32:
        """Spread of each channel below which it counts as still, shape (channels,)."""
        counts = {
            _SMALLEST_TURN: 6 * (len(self.joints) + (self.face == "expressions")),
            _SMALLEST_WEIGHT: {"arkit": 52, "expressions": 100, None: 0}[self.face],
            _SMALLEST_SHIFT: 0 if self.landmarks is None else 3 * self.landmarks.count,
        }
        return np.repeat(np.array([*counts], np.float32), [*counts.values()])

    def frames(self, clip: MotionClip) -> Floats32:
        """Return the clip's frames, shape (T, channels).

        Raises
        ------
        InputError
            If the clip lacks a channel.
        """
        parts = []
        joints = (*self.joints, "jaw") if self.face == "expressions" else self.joints
        if joints:
            rotations = clip.poses[:, [joint_index(name) for name in joints]]
            matrices = Rotation.from_rotvec(rotations.reshape(-1, 3)).as_matrix()
            parts.append(np.swapaxes(matrices[:, :, :2], 1, 2).astype(np.float32))
        if self.face is not None:
            values = getattr(clip, self.face)
            if values is None:
                raise InputError(
                    f"the clip holds no {_FACES[self.face]}, which the network was trained on",
                    remedy="Use clips that hold them, or train a network on these clips",
                )
            parts.append(values)
        if self.landmarks is not None:
            parts.append(self.landmarks.shifts(clip))
        return np.concatenate([part.reshape(len(clip), -1) for part in parts], axis=1)

    def description(self) -> str:
        """Return the channels in words."""
        parts = []
        if self.joints:
            parts.append(f"{len(self.joints)} joints, 6D rotations against the parent joint")
        if self.face == "arkit":
            parts.append("52 ARKit weights")
        elif self.face == "expressions":
            parts.append("the jaw's 6D rotation and 100 SMPL-X expression coefficients")
        if self.landmarks is not None:
            parts.append(f"{self.landmarks.count} face landmarks, metres from the neutral face")
        return "; ".join(parts)


JOINTS_OF_CHANNELS: Final = MappingProxyType[Channels, tuple[str, ...]](
    {
        "body": AMUSE_JOINTS,
        "gesture": GESTURE_JOINTS,
        "expression": (),
        "both": GESTURE_JOINTS,
        "landmarks": (),
    }
)
"""Joints whose rotations a network sees: AMUSE's, or all above the pelvis except the face, which is
the SMPL-X counterpart of BEAT's 47 joints."""


def face_of(clip: MotionClip) -> Face:
    """Return how a clip represents the face; ARKit weights if it has both.

    Raises
    ------
    InputError
        If it holds no face.
    """
    if clip.arkit is not None:
        return "arkit"
    if clip.expressions is not None:
        return "expressions"
    raise InputError(
        "the clip holds no face",
        remedy="Give clips with ARKit weights or SMPL-X expression coefficients",
    )


TOLERANCE: Final = 0.1
"""Seconds by which a clip may be shorter than one window; its last frame is repeated."""


def long_enough(frames: Floats32, window: int, frame_rate: float) -> Floats32:
    """Return a clip's frames, shape (T, C), with at least `window` of them.

    Raises
    ------
    InputError
        If the clip is shorter by more than `TOLERANCE`.
    """
    missing = window - len(frames)
    if missing <= 0:
        return frames
    if missing > TOLERANCE * frame_rate + 1e-6:
        raise InputError(
            f"the clip lasts {len(frames) / frame_rate:.2f} s and the network uses windows of "
            f"{window / frame_rate:.2f} s",
            remedy="Use longer clips, or a network of shorter windows (--config tiny has them)",
        )
    return np.concatenate([frames, np.repeat(frames[-1:], missing, axis=0)])


def cut_windows(frames: Floats32, window: int, stride: int) -> Floats32:
    """Return the complete windows of a clip's frames, shape (T, C), as shape (n, window, C)."""
    windows = np.lib.stride_tricks.sliding_window_view(frames, window, axis=0)[::stride]
    return np.array(windows.swapaxes(1, 2))
