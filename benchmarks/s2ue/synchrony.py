"""Synchrony of face and body: canonical correlation, learned from recordings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from training.spaces.bones_and_landmarks import BONE_VALUES

FloatArray = NDArray[np.float64]

COMPONENTS: Final = 8
"""Principal components of the face, and of the body, that are compared."""

_LEAST: Final = 1e-6
"""Share of the largest singular value below which a component is rounding error."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FaceBodySynchrony:
    """The directions of face and body that correlate most in recordings.

    This is FaceSync (Slaney & Covell 2000), which tests whether a voice belongs to a face, with the
    body instead of the voice: the canonical correlation of both, here of their first principal
    components. Only changes within a window count, so a constant posture or expression does not
    make a face match a body. The directions come from recordings alone and are the same for all
    measurements. An unrelated face and body score 0 on average; the ceiling is not 1, but the score
    of held-out recordings.

    Attributes
    ----------
    face : ndarray, shape (3 L,)
    body : ndarray, shape (27,)
        The directions.
    """

    face: FloatArray
    body: FloatArray

    @classmethod
    def of(cls, recorded: FloatArray) -> FaceBodySynchrony:
        """Learn from windows of recordings (N, T, 27 + 3 L)."""
        body, face = (
            one.reshape(-1, one.shape[-1])
            for one in np.split(_within(recorded), [BONE_VALUES], axis=2)
        )
        of_face, of_body = _whitening(face), _whitening(body)
        left, _, right = np.linalg.svd((face @ of_face).T @ (body @ of_body))
        return cls(face=of_face @ left[:, 0], body=of_body @ right[0])

    def __call__(self, faces: FloatArray, bodies: FloatArray | None = None) -> float:
        """Return the mean correlation of both within windows (N, T, 27 + 3 L).

        Parameters
        ----------
        faces : ndarray
            Windows with the faces.
        bodies : ndarray, optional
            Windows with the bodies; by default `faces`.

        Returns
        -------
        float
            In [-1, 1]; a window in which one of them stands still counts as 0.
        """
        face = _within(faces)[..., BONE_VALUES:] @ self.face
        body = _within(faces if bodies is None else bodies)[..., :BONE_VALUES] @ self.body
        spread = np.linalg.norm(face, axis=1) * np.linalg.norm(body, axis=1)
        together = (face * body).sum(axis=1)
        moves = spread > 0
        return float(np.where(moves, together / np.where(moves, spread, 1), 0).mean())


def _within(windows: FloatArray) -> FloatArray:
    """Return the windows minus their own means."""
    return np.asarray(windows - windows.mean(axis=1, keepdims=True))


def _whitening(values: FloatArray) -> FloatArray:
    """Return the matrix from values (N, values) to their principal components of variance 1."""
    _, lengths, axes = np.linalg.svd(values, full_matrices=False)
    count = min(COMPONENTS, int((lengths > _LEAST * lengths[0]).sum()))
    return np.asarray(axes[:count].T / (lengths[:count] / np.sqrt(len(values))))
