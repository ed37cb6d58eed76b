from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from motion.body.model import BodyModel
from motion.clip import MotionClip
from renderer.clip_video import Stage, still
from renderer.frames import FrameRenderer
from renderer.framing import Camera, frame_clips
from renderer.look import AVATARS, FRAMINGS, VIEWS, Look, default_body
from renderer.picture import PixelBox, plane_pixels
from tests.renderer.golden_frames import assert_like_golden

DARK = (0x2E, 0x34, 0x40)
LOOKS = {
    f"{framing}-{avatar}": Look(size=160, framing=framing, avatar=avatar)
    for avatar in AVATARS
    for framing in ("upper_body", "full_body")
} | {
    f"{framing}-{view}-on-dark": Look(size=160, framing=framing, view=view, background=DARK)
    for framing in FRAMINGS
    for view in VIEWS
}


@pytest.mark.parametrize("name", LOOKS)
def test_a_frame_matches_its_golden_picture(
    name: str, clip: MotionClip, body: BodyModel, tmp_path: Path
) -> None:
    look = LOOKS[name]
    with Stage(default_body(look.avatar), frame_clips([clip], body, look), look) as stage:
        assert_like_golden(np.asarray(still(stage, clip, 0.5)), name, tmp_path)


def test_the_face_matches_its_golden_picture(clip: MotionClip, tmp_path: Path) -> None:
    close = Camera(eye=(0, 0.28, 1.7), target=(0, 0.26, 0), field_of_view=10)
    with Stage(default_body(), close, Look(size=160)) as stage:
        assert_like_golden(np.asarray(still(stage, clip, 0.7)), "face", tmp_path)


@pytest.mark.parametrize(("framing", "metres"), [("face", 2.0), ("full_body", 20.0)])
def test_a_speaker_who_walks_far_is_seen_by_a_camera_far_away(
    framing: str, metres: float, clip: MotionClip, body: BodyModel
) -> None:
    look = Look(size=160, framing=framing)
    ahead = np.linspace([-metres, 0, 0], [metres, 0, 0], len(clip), dtype=np.float32)
    walking = replace(clip, trans=clip.trans + ahead)
    with Stage(default_body(), frame_clips([walking], body, look), look) as stage:
        picture = np.asarray(still(stage, walking, clip.duration / 2)).astype(int)
    assert (np.abs(picture - look.background).max(axis=2) > 60).any()


_FACING = np.tile(np.array([0, 0, 1], np.float32), (3, 1))
_BRIGHT = np.tile(np.array([0.8, 0.6, 0.6, 0.0], np.float32), (3, 1))


def test_triangles_that_leave_the_picture_stay_lit() -> None:
    chance = np.random.default_rng(0)
    camera = Camera(eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), field_of_view=30.0)
    with FrameRenderer(np.array([(0, 1, 2)]), _BRIGHT, camera, 64) as renderer:
        for _ in range(100):
            corners = chance.normal(size=(3, 3)).astype(np.float32)
            picture = renderer.draw(corners, _FACING)
            assert picture[..., :3].min() > 60


CLOSE = Camera(eye=(0.2, 0.1, 2.0), target=(0.2, 0.1, 0.0), field_of_view=14)
"""The figure ends beyond the picture's border."""


def _planes(stage: Stage, clip: MotionClip) -> list[NDArray[np.int_]]:
    frames = stage.video_frames(clip)
    return [plane_pixels(plane).astype(int) for frame in frames for plane in frame.planes]


@pytest.mark.parametrize(
    # With a shadow, pixels are interpolated, which rounds differently where a box begins.
    ("framing", "camera", "rounding"),
    [("upper_body", None, 0), ("upper_body", CLOSE, 0), ("full_body", None, 1)],
)
def test_video_frames_equal_whole_pictures(
    framing: str, camera: Camera | None, rounding: int, clip: MotionClip, body: BodyModel
) -> None:
    look = Look(size=160, framing=framing)
    part = clip.frames(slice(0, 4))
    with Stage(default_body(), camera or frame_clips([clip], body, look), look) as stage:
        cropped = _planes(stage, part)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(PixelBox, "around", lambda *_: PixelBox.full(look.size * 2))
            whole = _planes(stage, part)
    for plane, expected in zip(cropped, whole, strict=True):
        np.testing.assert_allclose(plane, expected, atol=rounding)
