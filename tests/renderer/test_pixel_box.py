from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.body import BodyModel
from motion.clip import MotionClip
from renderer.canvas import Canvas, plane_pixels
from renderer.clip_video import Stage
from renderer.framing import Camera
from renderer.look import Look
from renderer.pixel_box import PixelBox

SIDE = 320
ONWARDS = np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
"""A projection that only turns y downwards."""


@given(st.lists(st.tuples(st.floats(-3, 3), st.floats(-3, 3)), min_size=1, max_size=5))
def test_a_box_lies_in_the_picture_and_holds_all_points_of_it(
    points: list[tuple[float, float]],
) -> None:
    vertices = np.array([(x, y, 0) for x, y in points], np.float32)
    box = PixelBox.around(vertices, ONWARDS, SIDE)
    assert 0 <= box.left < box.left + box.width <= SIDE
    assert 0 <= box.top < box.top + box.height <= SIDE
    assert box.left % 16 == box.top % 16 == 0
    for x, y in points:
        if max(abs(x), abs(y)) < 1:
            column, row = (x + 1) / 2 * SIDE, (1 - y) / 2 * SIDE
            assert box.left <= column <= box.left + box.width
            assert box.top <= row <= box.top + box.height


def test_what_is_behind_the_camera_takes_the_whole_picture() -> None:
    projection = ONWARDS.copy()
    projection[3] = (0, 0, 1, 0)
    vertices = np.array([[0, 0, 1], [0, 0, -1]], np.float32)
    assert PixelBox.around(vertices, projection, SIDE) == PixelBox.whole(SIDE)


@pytest.mark.parametrize("framed", ["camera", "closer"])
def test_video_frames_are_those_of_whole_pictures(
    framed: str, clip: MotionClip, body: BodyModel, camera: Camera, small_look: Look,
    body_path: object,
) -> None:  # fmt: skip
    """The figure ends inside the picture with one camera, and beyond its border with the other."""
    close = Camera(eye=(0.2, 0.1, 2.0), target=(0.2, 0.1, 0.0), field_of_view=14)
    with Stage(body_path, camera if framed == "camera" else close, small_look) as stage:  # type: ignore[arg-type]
        part = clip.frames(slice(0, 4))
        cropped = [
            [plane_pixels(plane).copy() for plane in frame.planes]
            for frame in stage.video_frames(part)
        ]
        side = small_look.size * 2
        canvas = Canvas(small_look.size)
        for picture, planes in zip(stage.pictures(part), cropped, strict=True):
            whole = canvas.with_picture(picture, PixelBox.whole(side))
            for plane, expected in zip(planes, whole.planes, strict=True):
                np.testing.assert_array_equal(plane, plane_pixels(expected))


def test_a_box_round_boxes_holds_them_all_and_no_more() -> None:
    high = PixelBox(left=16, top=0, width=16, height=64)
    wide = PixelBox(left=0, top=32, width=128, height=16)
    assert PixelBox.round_all([high, wide]) == PixelBox(left=0, top=0, width=128, height=64)
