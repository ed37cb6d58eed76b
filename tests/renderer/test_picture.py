from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.body.model import BodyModel
from motion.clip import MotionClip
from renderer.clip_video import Stage
from renderer.framing import Camera
from renderer.look import Look
from renderer.picture import PixelBox, plane_pixels

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
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(PixelBox, "around", lambda *_: PixelBox.whole(small_look.size * 2))
            for whole, planes in zip(stage.video_frames(part), cropped, strict=True):
                for plane, expected in zip(planes, whole.planes, strict=True):
                    np.testing.assert_array_equal(plane, plane_pixels(expected))


def test_a_video_frame_has_the_colours_of_the_picture(
    clip: MotionClip, camera: Camera, small_look: Look, body_path: object
) -> None:
    part = clip.frames(slice(0, 1))
    with Stage(body_path, camera, small_look) as stage:  # type: ignore[arg-type]
        picture = next(stage.pictures(part))[..., :3].astype(float)
        frame = next(stage.video_frames(part)).to_ndarray(format="rgb24").astype(float)
    size = small_look.size
    averaged = picture.reshape(size, 2, size, 2, 3).mean(axis=(1, 3))
    # The test reads the frame back without being told that it is BT.709, hence only its luma.
    weights = np.array([0.299, 0.587, 0.114])
    assert np.abs((averaged - frame) @ weights).mean() < 3


def test_a_box_round_boxes_holds_them_all_and_no_more() -> None:
    high = PixelBox(left=16, top=0, width=16, height=64)
    wide = PixelBox(left=0, top=32, width=128, height=16)
    assert PixelBox.round_all([high, wide]) == PixelBox(left=0, top=0, width=128, height=64)
