from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import joint_index
from renderer.clip_video import Stage, still
from renderer.figures.panels import joints_of
from renderer.framing import Camera, frame_clips, project
from renderer.look import BACKGROUND, FRAMINGS, VIEWS, Look, default_body
from renderer.shown_clip import frame_at

HANDS = ("left_middle3", "right_middle3")
ARMS = (*HANDS, "left_elbow", "right_elbow")
JOINTS = {
    "face": ("head", "neck", "left_eye", "right_eye"),
    "hands": ARMS,
    "upper_body": (*HANDS, "head"),
    "full_body": (*HANDS, "head", "left_foot", "right_foot"),
}
"""Joints that each framing shows."""


def _is_in_picture(
    clip: MotionClip, body: BodyModel, names: tuple[str, ...], camera: Camera
) -> bool:
    points = joints_of(clip, body)[:, [joint_index(name) for name in names]]
    pixels = project(points, camera, 100)[..., :2]
    return bool(pixels.min() > 0 and pixels.max() < 100)


@pytest.fixture
def arms_wide(clip: MotionClip) -> MotionClip:
    return replace(clip, poses=np.zeros_like(clip.poses), arkit=None)


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("framing", FRAMINGS)
def test_the_framed_joints_even_of_one_wide_clip_in_ten_in_any_order_are_in_the_picture(
    framing: str, view: str, clip: MotionClip, arms_wide: MotionClip, body: BodyModel
) -> None:
    clips, look = [clip] * 9 + [arms_wide], Look(framing=framing, view=view)
    camera = frame_clips(clips, body, look)
    assert all(_is_in_picture(each, body, JOINTS[framing], camera) for each in (clip, arms_wide))
    assert camera == frame_clips(clips[::-1], body, look)


def test_slightly_smaller_motion_keeps_the_camera(
    clip: MotionClip, arms_wide: MotionClip, body: BodyModel
) -> None:
    cameras = set()
    for bend in np.linspace(0, 0.04, 9, dtype=np.float32):
        poses = arms_wide.poses.copy()
        poses[:, joint_index("left_elbow"), 1] = bend
        cameras.add(frame_clips([clip, replace(arms_wide, poses=poses)], body, Look()))
    assert len(cameras) <= 2


def test_an_outlier_frame_does_not_shrink_the_figures(clip: MotionClip, body: BodyModel) -> None:
    many = clip.frames(np.tile(np.arange(len(clip)), 40))
    trans = many.trans.copy()
    trans[0, 0] = 30.0
    stray = replace(many, trans=trans)
    assert frame_clips([stray], body, Look()).eye[2] == pytest.approx(
        frame_clips([many], body, Look()).eye[2], rel=0.1
    )


@pytest.mark.parametrize(
    "bad",
    [
        *({"size": size} for size in (8, 721)),
        {"frame_rate": 0},
        *({name: "x"} for name in ("framing", "view", "avatar")),
    ],
)
def test_an_invalid_look_is_refused(bad: dict[str, Any]) -> None:
    with pytest.raises(InputError):
        Look(**bad)


def test_projected_joints_lie_on_the_drawn_body(
    clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    seconds = 0.4
    with Stage(default_body(), camera, Look(size=240)) as stage:
        picture = np.asarray(still(stage, clip, seconds)).astype(int)
    joints = joints_of(frame_at(clip, seconds), body)[0]
    names = ("head", "left_elbow", "right_elbow", "left_middle1", "right_middle1", "spine2")
    for name in names:
        x, y, _ = project(joints[joint_index(name)], camera, 240)
        assert np.abs(picture[int(y), int(x)] - BACKGROUND).max() > 10, name
    for aside in (-0.2, 0.2):
        x, y, _ = project(joints[joint_index("head")] + [aside, 0, 0], camera, 240)
        assert np.abs(picture[int(y), int(x)] - BACKGROUND).max() <= 2, "beside the head"
