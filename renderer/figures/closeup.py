"""A camera for faces: what lips, brows and eyes do is too small to see in a study's own picture."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np

from motion.body import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.figures.skeleton_lines import joints_of
from renderer.framing import Camera

_FACE: Final = 0.17
"""Metres from between the eyes to the edge of the picture, where the head holds still."""
_BELOW_EYES: Final = 0.03


def face_camera(clips: Iterable[MotionClip], body: BodyModel, camera: Camera) -> Camera:
    """Return a camera beside `camera` that sees the faces of all `clips`, all the time.

    Parameters
    ----------
    clips : iterable of MotionClip
        At least one; all are seen alike.
    body : BodyModel
        The body that they are put on.
    camera : Camera
        How far away it stands; it moves in height and to the side.
    """
    eyes = [joint_index("left_eye"), joint_index("right_eye")]
    points = np.concatenate([joints_of(clip, body)[:, eyes].mean(axis=1) for clip in clips])
    low, high = points.min(axis=0), points.max(axis=0)
    x, y, z = (low + high) / 2
    half = float((high - low)[:2].max() / 2) + _FACE
    distance = camera.eye[2] - float(high[2])
    return Camera(
        eye=(float(x), float(y) - _BELOW_EYES, camera.eye[2]),
        target=(float(x), float(y) - _BELOW_EYES, float(z)),
        field_of_view=float(np.degrees(2 * np.arctan(half / distance))),
    )
