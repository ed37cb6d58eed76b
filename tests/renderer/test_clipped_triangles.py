"""Triangles that the picture's border cuts keep their colour."""

from __future__ import annotations

import numpy as np

from renderer.frames import FrameRenderer
from renderer.framing import Camera

_FACING = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
_BRIGHT = np.tile(np.array([0.8, 0.6, 0.6, 0.0], np.float32), (3, 1))


def test_no_triangle_that_reaches_out_of_the_picture_turns_dark() -> None:
    chance = np.random.default_rng(0)
    camera = Camera(eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), field_of_view=30.0)
    with FrameRenderer(np.array([(0, 1, 2)]), _BRIGHT, camera, 64) as renderer:
        for _ in range(100):
            corners = chance.normal(size=(3, 3)).astype(np.float32)
            picture = renderer.draw(corners, _FACING)
            assert picture[..., :3].min() > 60
