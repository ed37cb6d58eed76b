from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.clip_video import Stage
from renderer.figures.skeleton_lines import joints_of
from renderer.framing import Camera, project
from renderer.look import BACKGROUND, Look
from renderer.stills import frame_at, still

LEVEL = Camera(eye=(0.0, 1.0, 5.0), target=(0.0, 1.0, 0.0), field_of_view=20.0)


def test_what_the_camera_looks_at_is_in_the_middle() -> None:
    np.testing.assert_allclose(project(np.array([0.0, 1.0, 0.0]), LEVEL, 200), [100, 100, 5])


def test_right_of_the_camera_is_right_and_up_is_up() -> None:
    reach = 5 * np.tan(np.radians(10))
    corner = project(np.array([reach, 1.0 + reach, 0.0]), LEVEL, 200)
    np.testing.assert_allclose(corner, [200, 0, 5], atol=1e-9)


def test_a_point_behind_the_camera_is_nowhere() -> None:
    assert np.isnan(project(np.array([0.0, 1.0, 6.0]), LEVEL, 200)).all()


@pytest.mark.parametrize("seconds", [0.0, 0.4, 0.75])
def test_joints_land_on_the_drawn_body(
    seconds: float, clip: MotionClip, body: BodyModel, body_path: Path, camera: Camera
) -> None:
    with Stage(body_path, camera, Look(size=240)) as stage:
        picture = np.asarray(still(stage, clip, seconds)).astype(int)
    joints = joints_of(frame_at(clip, seconds), body)[0]
    names = ("head", "left_elbow", "right_elbow", "left_middle1", "right_middle1", "spine2")
    for name in names:
        x, y, _ = project(joints[joint_index(name)], camera, 240)
        assert np.abs(picture[int(y), int(x)] - BACKGROUND).max() > 10, name
    for aside in (-0.2, 0.2):
        x, y, _ = project(joints[joint_index("head")] + [aside, 0, 0], camera, 240)
        assert np.abs(picture[int(y), int(x)] - BACKGROUND).max() <= 2, "beside the head"
