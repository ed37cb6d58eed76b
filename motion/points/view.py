"""Seeing a person from the front, wherever the camera was.

View normalisation of Speech2UnifiedExpressions (Bhattacharya et al. 2024, section 3.1) after
Umeyama 1991, "Least-squares estimation of transformation parameters between two point patterns".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation

FloatArray = NDArray[np.float64]

_SLOW: Final = 2.0
"""Seconds, a standard deviation: slower turns of a whole trunk count as the camera's."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Similarity:
    """Turn, scale and shift, one for each frame.

    Attributes
    ----------
    turns : Rotation
        T of them.
    scales : ndarray, shape (T,)
    shifts : ndarray, shape (T, 3)
    """

    turns: Rotation
    scales: FloatArray
    shifts: FloatArray

    def apply(self, points: FloatArray) -> FloatArray:
        """Return `points`, shape (T, P, 3), turned, scaled and shifted frame by frame."""
        turned = np.einsum("tab,tpb->tpa", self.turns.as_matrix(), points)
        return np.asarray(self.scales[:, None, None] * turned + self.shifts[:, None])


def nearest_similarity(points: FloatArray, reference: FloatArray) -> Similarity:
    """Return what brings the points of each frame nearest to the reference, after Umeyama.

    Parameters
    ----------
    points : ndarray, shape (T, P, 3)
    reference : ndarray, shape (P, 3)
        The same points in the normal view.
    """
    centres, centre = points.mean(axis=1), reference.mean(axis=0)
    away, wanted = points - centres[:, None], reference - centre
    turns = Rotation.concatenate([Rotation.align_vectors(wanted, frame)[0] for frame in away])
    turned = np.einsum("tab,tpb->tpa", turns.as_matrix(), away)
    scales = (turned * wanted).sum(axis=(1, 2)) / (away**2).sum(axis=(1, 2))
    return Similarity(
        turns=turns, scales=scales, shifts=centre - scales[:, None] * turns.apply(centres)
    )


def front_views(trunk: FloatArray, reference: FloatArray, frame_rate: float) -> Rotation:
    """Return the turns by which a trunk faces front and stands upright on average.

    Only what changes slowly is taken out, so that a camera's place and moves go and the person's
    own leaning and turning stay.

    Parameters
    ----------
    trunk : ndarray, shape (T, P, 3)
    reference : ndarray, shape (P, 3)
        The same points of somebody who stands upright and faces front.
    frame_rate : float
        Frames per second.
    """
    centred = trunk - trunk.mean(axis=1, keepdims=True)
    slow = gaussian_filter1d(centred, _SLOW * frame_rate, axis=0, mode="nearest")
    return nearest_similarity(slow, reference).turns
