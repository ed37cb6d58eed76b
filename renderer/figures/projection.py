"""Where points of the world lie in a picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from renderer.frames import looking
from renderer.framing import Camera


def project(points: NDArray[np.floating], camera: Camera, size: int) -> NDArray[np.float64]:
    """Return where `camera` sees `points` in a picture of `size` × `size` pixels.

    Parameters
    ----------
    points : ndarray, shape (..., 3)
        Positions in metres.
    camera : Camera
        Where the picture is taken from.
    size : int
        Pixels along each side.

    Returns
    -------
    ndarray, shape (..., 3)
        Pixels from the left and from the top, and metres before the camera. Points behind it are
        not a number.
    """
    pose = looking(np.array(camera.eye), np.array(camera.target))
    seen = (np.asarray(points, float) - pose[:3, 3]) @ pose[:3, :3]
    ahead = np.where(seen[..., 2] < 0, -seen[..., 2], np.nan)
    reach = ahead * np.tan(np.radians(camera.field_of_view / 2))
    x = (seen[..., 0] / reach + 1) / 2 * size
    y = (1 - seen[..., 1] / reach) / 2 * size
    return np.stack([x, y, ahead], axis=-1)
