from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.figures.skeleton_lines import SIDE_COLOURS, joints_of, with_skeleton
from renderer.framing import Camera, project
from renderer.shown_clip import frame_at

SIZE = 240


@pytest.fixture
def joints(clip: MotionClip, body: BodyModel) -> np.ndarray:
    return np.asarray(joints_of(frame_at(clip, 0.4), body)[0])


def drawn(joints: np.ndarray, camera: Camera) -> np.ndarray:
    plain = Image.new("RGB", (SIZE, SIZE), "white")
    return np.asarray(with_skeleton(plain, joints, camera)).astype(int)


def test_each_elbow_has_the_colour_of_its_side(joints: np.ndarray, camera: Camera) -> None:
    picture = drawn(joints, camera)
    for side, colour in SIDE_COLOURS.items():
        x, y, _ = project(joints[joint_index(f"{side}_elbow")], camera, SIZE)
        assert np.abs(picture[int(y), int(x)] - colour).max() <= 3


def test_the_sides_differ_in_shape_as_well_as_colour(joints: np.ndarray, camera: Camera) -> None:
    # Shifted to one place and repainted, a round joint and a square one are not the same.
    shapes = []
    for side in SIDE_COLOURS:
        one_arm = np.full_like(joints, np.nan)
        arm = [joint_index(f"{side}_{joint}") for joint in ("elbow", "shoulder")]
        one_arm[arm] = (*camera.target[:2], 0)
        part = drawn(one_arm, camera)[: SIZE * 3 // 4]
        shapes.append((np.abs(part - SIDE_COLOURS[side]).max(axis=-1) < 40).sum())
    assert 0 < shapes[0] < shapes[1]
