"""The soft shadow under a standing body, which shows that it stands on the ground.

One ellipse under each foot fades as the foot lifts, and a wide, faint one is under the body. The
ground itself is invisible: the background stays plain.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np

from motion.arrays import Floats, Floats32, Indices
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.placement import ground_height
from motion.skeleton import joint_index

ELLIPSES: Final = 3
"""Ellipses of a shadow: left foot, right foot, body."""

_SOLE_HEIGHT: Final = 0.03
"""Height in metres above a foot's lowest point up to which it counts as its sole."""

_FOOT_DARKNESS: Final = 0.48
_FOOT_MARGIN: Final = 0.055  # metres that the shadow reaches beyond heel and toes
_FOOT_HALF_WIDTH: Final = 0.095
_FOOT_DECAY: Final = 0.07  # metres of lift after which a third is left

_BODY_DARKNESS: Final = 0.17
_BODY_HALF_AXES: Final = (0.50, 0.32)
_BODY_OFFSET: Final = (0.05, -0.05)  # away from the key light
_BODY_DECAY: Final = 0.35


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactShadow:
    """A shadow on level ground.

    Attributes
    ----------
    ground : float
        Height of the ground in metres.
    centres : ndarray, shape (3, 2)
        Positions of the ellipses, x and z in metres.
    axes : ndarray, shape (3, 2, 2)
        Half axes of the ellipses in metres, one per column, x and z.
    darkness : ndarray, shape (3,)
        Share of the light that is missing at each centre; it falls smoothly to zero at the rim.
    """

    ground: float
    centres: Floats32
    axes: Floats32
    darkness: Floats32

    def corners(self) -> Floats32:
        """Return the corners of a level rectangle around all ellipses, shape (4, 3)."""
        half = np.linalg.norm(self.axes, axis=2)
        left, back = (self.centres - half).min(axis=0)
        right, front = (self.centres + half).max(axis=0)
        return np.array(
            [
                (left, self.ground, front), (right, self.ground, front),
                (right, self.ground, back), (left, self.ground, back),
            ],
            np.float32,
        )  # fmt: skip


class ShadowCaster:
    """Finds the shadow under a body in any pose."""

    def __init__(self, body: BodyModel) -> None:
        self._body = body
        strongest = np.asarray(body.weights.toarray().argmax(axis=1))
        self._soles = [_sole(body, strongest, side) for side in ("left", "right")]
        lowest = min(float(body.template[sole, 1].min()) for sole in self._soles)
        unshaped = body.joints(np.zeros(0))
        self._thickness = ground_height(unshaped) - lowest

    def ground(self, clip: MotionClip) -> float:
        """Return the height of the ground under a body of the clip's shape."""
        return ground_height(self._body.joints(clip.betas)) - self._thickness

    def shadow(self, vertices: Floats32, ground: float) -> ContactShadow:
        """Return the shadow of a body with `vertices`, shape (V, 3), above `ground`."""
        feet = [vertices[sole] for sole in self._soles]
        lifts = np.array([max(float(foot[:, 1].min()) - ground, 0.0) for foot in feet])
        middles = np.array([foot[:, [0, 2]].mean(axis=0) for foot in feet])
        trunk = vertices[:, [0, 2]].mean(axis=0)
        centres = np.array([*middles, (middles.mean(axis=0) + trunk) / 2 + _BODY_OFFSET])
        axes = np.array([*(_foot_axes(foot) for foot in feet), np.diag(_BODY_HALF_AXES)])
        darkness = np.append(
            _FOOT_DARKNESS * np.exp(-lifts / _FOOT_DECAY),
            _BODY_DARKNESS * np.exp(-lifts.min() / _BODY_DECAY),
        )
        return ContactShadow(
            ground=ground,
            centres=centres.astype(np.float32),
            axes=axes.astype(np.float32),
            darkness=darkness.astype(np.float32),
        )


def _sole(body: BodyModel, strongest: Indices, side: str) -> Indices:
    """Return the vertices of one foot's sole, from heel to toes."""
    joints = [joint_index(f"{side}_{part}") for part in ("ankle", "foot")]
    foot = np.flatnonzero(np.isin(strongest, joints))
    height = body.template[foot, 1]
    sole = foot[height < height.min() + _SOLE_HEIGHT]
    return np.asarray(sole[np.argsort(body.template[sole, 2], kind="stable")])


def _foot_axes(sole: Floats32) -> Floats:
    """Return the half axes of the ellipse under a sole, along it and across it, shape (2, 2)."""
    heel_to_toes = (sole[-1] - sole[0])[[0, 2]].astype(np.float64)
    length = float(np.linalg.norm(heel_to_toes))
    # A foot on tiptoe has no direction on the ground.
    direction = heel_to_toes / length if length > 0.02 else np.array([0.0, 1.0])
    normal = np.array([direction[1], -direction[0]])
    return np.stack([direction * (length / 2 + _FOOT_MARGIN), normal * _FOOT_HALF_WIDTH], axis=1)
