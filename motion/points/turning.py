"""Rotations that align directions, and a person seen from the front, for all frames at once.

View normalisation of Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 3.1) after
Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns".
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

from motion.arrays import Floats

_ANTIPARALLEL = 1e-9
"""Below this, one plus the cosine between two directions means that they are opposite."""


def smallest_rotations(current: Floats, target: Floats) -> Rotation:
    """Return the smallest rotations from directions `current` to `target`, each (T, 3)."""
    current, target = _units(current), _units(target)
    scalar = 1 + (current * target).sum(axis=1)
    vector = np.cross(current, target)
    opposite = scalar < _ANTIPARALLEL
    if opposite.any():
        least = np.eye(3)[np.abs(current[opposite]).argmin(axis=1)]
        vector[opposite] = _units(np.cross(current[opposite], least))
    return Rotation.from_quat(np.column_stack([vector, scalar]))


def frame_rotations(current: tuple[Floats, Floats], target: tuple[Floats, Floats]) -> Rotation:
    """Return the rotations that align one direction exactly and another as closely as possible.

    Parameters
    ----------
    current : pair of ndarray, shape (3,)
        Two directions at rest.
    target : pair of ndarray, shape (T, 3)
        The directions in each frame. If they are parallel, the rotation about them is arbitrary.
    """
    rest = _frames(current[0][None], current[1][None])
    return Rotation.from_matrix(_frames(*target) @ np.swapaxes(rest, 1, 2))


def _frames(first: Floats, second: Floats) -> Floats:
    """Return right-handed frames (T, 3, 3) whose columns are the axes, the first along `first`."""
    first = _units(first)
    normal = np.cross(first, second)
    line = np.linalg.norm(normal, axis=1) < _ANTIPARALLEL
    if line.any():
        normal[line] = np.cross(first[line], np.eye(3)[np.abs(first[line]).argmin(axis=1)])
    third = _units(normal)
    return np.stack([first, np.cross(third, first), third], axis=2)


def _units(vectors: Floats) -> Floats:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=-1, keepdims=True))


_SLOW: Final = 2.0
"""Standard deviation of a smoothing in seconds: slower turns of the trunk count as the camera's."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Similarity:
    """Rotation, scale and shift of each frame.

    Attributes
    ----------
    turns : Rotation
        T rotations.
    scales : ndarray, shape (T,)
    shifts : ndarray, shape (T, 3)
    """

    turns: Rotation
    scales: Floats
    shifts: Floats

    def apply(self, points: Floats) -> Floats:
        """Return `points`, shape (T, P, 3), rotated, scaled and shifted frame by frame."""
        rotated = np.einsum("tab,tpb->tpa", self.turns.as_matrix(), points)
        return np.asarray(self.scales[:, None, None] * rotated + self.shifts[:, None])


def nearest_similarity(points: Floats, reference: Floats) -> Similarity:
    """Return the similarity from each frame's points to the reference, after Umeyama.

    Parameters
    ----------
    points : ndarray, shape (T, P, 3)
    reference : ndarray, shape (P, 3)
        The same points in the normal view.
    """
    centres, centre = points.mean(axis=1), reference.mean(axis=0)
    centred, target = points - centres[:, None], reference - centre
    turns = Rotation.concatenate([Rotation.align_vectors(target, frame)[0] for frame in centred])
    rotated = np.einsum("tab,tpb->tpa", turns.as_matrix(), centred)
    scales = (rotated * target).sum(axis=(1, 2)) / (centred**2).sum(axis=(1, 2))
    return Similarity(
        turns=turns, scales=scales, shifts=centre - scales[:, None] * turns.apply(centres)
    )


def front_views(trunk: Floats, reference: Floats, frame_rate: float) -> Rotation:
    """Return the rotations that make a trunk face front and stand upright on average.

    Only slow changes are removed: the camera's position and moves go, the person's leaning and
    turning stay.

    Parameters
    ----------
    trunk : ndarray, shape (T, P, 3)
    reference : ndarray, shape (P, 3)
        The same points of a person standing upright and facing front.
    frame_rate : float
        Frames per second.
    """
    centred = trunk - trunk.mean(axis=1, keepdims=True)
    slow = gaussian_filter1d(centred, _SLOW * frame_rate, axis=0, mode="nearest")
    return nearest_similarity(slow, reference).turns
