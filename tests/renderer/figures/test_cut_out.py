from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.clip_video import Stage
from renderer.figures.cut_out import FAR, CutOut, box_around, cut_out
from renderer.figures.panels import aspect_of, common_box, cropped
from renderer.figures.skeleton_lines import joints_of
from renderer.framing import Camera, project
from renderer.look import BACKGROUND, Look
from renderer.stills import frame_at, still


@pytest.fixture(scope="module")
def stage(body_path: Path, camera: Camera, small_look: Look) -> Iterator[Stage]:
    with Stage(body_path, camera, small_look) as stage:
        yield stage


@pytest.fixture(scope="module")
def figure(stage: Stage, clip: MotionClip, camera: Camera) -> CutOut:
    return cut_out(stage, frame_at(clip, 0.4), camera)


def test_a_figure_put_back_on_its_background_is_the_frame(
    figure: CutOut, stage: Stage, clip: MotionClip
) -> None:
    ground = Image.new("RGBA", figure.picture.size, (*BACKGROUND, 255))
    ground.alpha_composite(figure.picture)
    put_back = np.asarray(ground.convert("RGB")).astype(int)
    drawn = np.asarray(still(stage, clip, 0.4)).astype(int)
    assert np.abs(put_back - drawn).max() <= 4


def test_nothing_of_the_background_is_left_on_the_edges(figure: CutOut) -> None:
    pixels = np.asarray(figure.picture).astype(int)
    alpha = pixels[..., 3]
    assert (alpha[:4] == 0).all()
    assert alpha[-4:, 70:90].min() == 255
    partly = (alpha > 60) & (alpha < 200)
    assert partly.any()
    assert np.abs(pixels[partly, :3] - BACKGROUND).max(axis=-1).min() > 10


def test_depth_says_where_the_figure_is_and_how_far(
    figure: CutOut, clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    solid = np.asarray(figure.picture)[..., 3] == 255
    assert (figure.depth[solid] < FAR).all()
    assert (figure.depth[:4] == FAR).all()
    joints = joints_of(frame_at(clip, 0.4), body)[0]
    x, y, depth = project(joints[joint_index("spine2")], camera, 160)
    # The chest's surface lies before its joint.
    assert depth - 0.25 < figure.depth[int(y), int(x)] < depth


def test_a_box_holds_the_whole_figure_and_little_else(
    figure: CutOut, clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    left, top, right, bottom = box_around(body, frame_at(clip, 0.4), camera)
    ys, xs = np.nonzero(np.asarray(figure.picture)[..., 3])
    assert left * 160 == pytest.approx(xs.min(), abs=1.5)
    assert right * 160 == pytest.approx(xs.max() + 1, abs=1.5)
    assert top * 160 == pytest.approx(ys.min(), abs=1.5)
    assert bottom == 1


def test_a_common_box_holds_every_figure(clip: MotionClip, body: BodyModel, camera: Camera) -> None:
    poses = [frame_at(clip, seconds) for seconds in (0.0, 0.3, 0.7)]
    common = common_box(body, poses, camera)
    for pose in poses:
        left, top, right, bottom = box_around(body, pose, camera)
        assert common[0] <= left and common[1] <= top
        assert common[2] >= right and common[3] >= bottom


def test_cutting_to_a_box_keeps_what_is_inside() -> None:
    picture = Image.new("RGBA", (100, 100), "white")
    picture.paste("red", (25, 50, 75, 100))
    box = (0.25, 0.5, 0.75, 1.0)
    assert aspect_of(box) == 1
    assert cropped(picture, box, (50, 50)).getcolors() == [(2500, (255, 0, 0, 255))]


def test_a_part_of_a_cut_out_has_its_picture_and_its_depth(figure: CutOut) -> None:
    part = figure.within((0.25, 0.5, 0.75, 1.0))
    assert part.picture.size == part.depth.shape[::-1] == (80, 80)
    np.testing.assert_array_equal(part.depth, figure.depth[80:160, 40:120])
    np.testing.assert_array_equal(
        np.asarray(part.picture), np.asarray(figure.picture)[80:160, 40:120]
    )
