"""A motion clip: what one body and face do over time, in SMPL-X's own terms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.skeleton import JOINT_COUNT

FloatArray = NDArray[np.float32]

ARKIT_COUNT: Final = 52
EXPRESSION_COUNT: Final = 100
GENDERS: Final = ("neutral", "female", "male")
MIN_FRAME_RATE: Final = 1.0
MAX_FRAME_RATE: Final = 1000.0
LARGEST_VALUE: Final = 1e6
"""Far beyond any radian, metre or coefficient of a body; larger numbers are damage."""


def check_frame_rate(frame_rate: float) -> None:
    """Raise `InputError` where `frame_rate` is not from 1 to 1000 frames per second."""
    if not MIN_FRAME_RATE <= frame_rate <= MAX_FRAME_RATE:
        raise InputError(
            f"frame rate {frame_rate:g} is not usable",
            remedy=f"Give frames per second from {MIN_FRAME_RATE:.0f} to {MAX_FRAME_RATE:.0f}",
        )


@dataclass(frozen=True, kw_only=True)
class MotionClip:
    """One motion clip; it checks its own shapes, finiteness and frame rate when it is made.

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
        ARKit blendshape weights in [0, 1], in the order of `motion.face.ARKIT_NAMES`.
    gender : str
        ``neutral``, ``female`` or ``male``: which SMPL-X template the betas belong to.
    provenance : mapping of str to str
        Where the clip comes from: generator, seed, source file, what was changed on the way.

    Raises
    ------
    InputError
        If a shape, value or the frame rate is not as stated.
    """

    poses: FloatArray
    trans: FloatArray
    frame_rate: float
    betas: FloatArray = field(default_factory=lambda: np.zeros(0, np.float32))
    expressions: FloatArray | None = None
    arkit: FloatArray | None = None
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
        given = np.asarray(getattr(self, name))
        if given.shape != shape:
            raise InputError(
                f"{name} has shape {given.shape}, expected {shape}",
                remedy="Check that all arrays of the clip have the same number of frames",
            )
        usable = np.abs(given) <= LARGEST_VALUE
        if not usable.all():
            bad = tuple(map(int, np.argwhere(~usable)[0]))
            if np.isfinite(given[bad]):
                raise InputError(
                    f"{name} holds {given[bad]:.3g} at index {bad}",
                    remedy="Give radians, metres and coefficients; repair damaged frames",
                )
            raise InputError(
                f"{name} holds a value that is not a number at index {bad}",
                remedy="Repair or cut the frames that hold NaN or infinity",
            )
        array = np.array(given, dtype=np.float32)
        array.setflags(write=False)
        object.__setattr__(self, name, array)

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.poses)

    @property
    def duration(self) -> float:
        """Length in seconds: each frame stands for one frame interval."""
        return len(self) / self.frame_rate

    def frames(self, index: slice | NDArray[np.int_]) -> Self:
        """Return the clip made of the frames that `index` picks, in that order."""
        return replace(
            self,
            poses=self.poses[index],
            trans=self.trans[index],
            expressions=None if self.expressions is None else self.expressions[index],
            arkit=None if self.arkit is None else self.arkit[index],
        )

    def with_provenance(self, **facts: str) -> Self:
        """Return the clip with `facts` added to its provenance."""
        return replace(self, provenance={**self.provenance, **facts})
