from __future__ import annotations

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.figures.panels import face_camera, faces_level
from renderer.figures.skeleton_lines import joints_of
from renderer.framing import Camera, project
from renderer.stills import frame_at


def test_the_face_fills_the_picture_and_is_never_cut(
    clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    close = face_camera([clip], body, camera)
    assert close.field_of_view < camera.field_of_view / 2
    for name in ("left_eye", "right_eye", "head"):
        seen = project(joints_of(clip, body)[:, joint_index(name)], close, 100)[:, :2]
        assert seen.min() > 20 and seen.max() < 80


def test_faces_of_who_sits_and_who_stands_are_in_one_place(
    clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    seated = MotionClip(poses=clip.poses, trans=clip.trans - [0.1, 0.45, 0.2], frame_rate=30)
    level = faces_level([[clip], [seated]], body)
    close = face_camera([each for group in level for each in group], body, camera)
    seen = [
        project(joints_of(each, body)[:, joint_index("left_eye")], close, 100) for (each,) in level
    ]
    np.testing.assert_allclose(seen[0], seen[1], atol=0.01)
    assert close.field_of_view == face_camera([clip], body, camera).field_of_view


def test_all_clips_are_seen_by_one_camera(
    clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    aside = MotionClip(poses=clip.poses, trans=clip.trans + np.array([0.3, 0, 0]), frame_rate=30)
    close = face_camera([frame_at(clip, 0), frame_at(aside, 0)], body, camera)
    eyes = [
        project(joints_of(frame_at(each, 0), body)[0, joint_index("left_eye")], close, 100)
        for each in (clip, aside)
    ]
    assert eyes[1][0] - eyes[0][0] == pytest.approx(100 * 0.3 / 0.64, rel=0.1)
    assert np.isfinite(eyes).all()
