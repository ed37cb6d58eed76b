from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.clip_video import Stage, still
from renderer.figures.panels import (
    NO_DEPTH,
    CutOut,
    align_faces,
    common_box,
    cut_out,
    face_camera,
    joints_of,
)
from renderer.framing import Camera, frame_clips, project
from renderer.look import BACKGROUND, VIEWS, default_body
from renderer.shown_clip import frame_at
from tests.motion.random_clips import clip_of
from tests.renderer.conftest import SMALL_LOOK


@pytest.fixture(scope="module")
def stage(camera: Camera) -> Iterator[Stage]:
    with Stage(default_body(), camera, SMALL_LOOK) as stage:
        yield stage


@pytest.fixture(scope="module")
def figure(stage: Stage, clip: MotionClip, camera: Camera) -> CutOut:
    return cut_out(stage, frame_at(clip, 0.4), camera)


def test_a_cut_out_figure_on_its_background_restores_the_frame(
    figure: CutOut, stage: Stage, clip: MotionClip
) -> None:
    ground = Image.new("RGBA", figure.picture.size, (*BACKGROUND, 255))
    ground.alpha_composite(figure.picture)
    put_back = np.asarray(ground.convert("RGB")).astype(int)
    expected = np.asarray(still(stage, clip, 0.4)).astype(int)
    assert np.abs(put_back - expected).max() <= 4


def test_edges_hold_no_trace_of_the_background(figure: CutOut) -> None:
    pixels = np.asarray(figure.picture).astype(int)
    alpha = pixels[..., 3]
    assert (alpha[:4] == 0).all()
    assert alpha[-4:, 70:90].min() == 255
    partly = (alpha > 60) & (alpha < 200)
    assert partly.any()
    assert np.abs(pixels[partly, :3] - BACKGROUND).max(axis=-1).min() > 10


def test_depth_is_the_figures_distance(
    figure: CutOut, clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    solid = np.asarray(figure.picture)[..., 3] == 255
    assert (figure.depth[solid] < NO_DEPTH).all()
    assert (figure.depth[:4] == NO_DEPTH).all()
    joints = joints_of(frame_at(clip, 0.4), body)[0]
    x, y, depth = project(joints[joint_index("spine2")], camera, 160)
    # The chest's surface lies before its joint.
    assert depth - 0.25 < figure.depth[int(y), int(x)] < depth


def test_a_box_contains_the_whole_figure_tightly(
    figure: CutOut, clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    left, top, right, bottom = common_box(body, [frame_at(clip, 0.4)], camera)
    ys, xs = np.nonzero(np.asarray(figure.picture)[..., 3])
    margin = 0.02 * 160
    assert left * 160 == pytest.approx(xs.min() - margin, abs=1.5)
    assert right * 160 == pytest.approx(xs.max() + 1 + margin, abs=1.5)
    assert top * 160 == pytest.approx(ys.min() - margin, abs=1.5)
    assert bottom == 1


@pytest.mark.parametrize("view", VIEWS)
def test_the_face_fills_the_picture_uncropped_from_the_cameras_side(
    view: str, clip: MotionClip, body: BodyModel
) -> None:
    camera = frame_clips([clip], body, replace(SMALL_LOOK, view=view))
    close = face_camera([clip], body, camera)
    assert close.field_of_view < camera.field_of_view / 2
    far, near = (np.subtract(each.eye, each.target) for each in (camera, close))
    np.testing.assert_allclose(near / np.linalg.norm(near), far / np.linalg.norm(far), atol=1e-3)
    for name in ("left_eye", "right_eye", "head"):
        projected = project(joints_of(clip, body)[:, joint_index(name)], close, 100)[:, :2]
        assert projected.min() > 20 and projected.max() < 80


def test_faces_of_seated_and_standing_speakers_coincide(
    clip: MotionClip, body: BodyModel, camera: Camera
) -> None:
    seated = clip_of(clip.poses, clip.trans - [0.1, 0.45, 0.2])
    level = align_faces([[clip], [seated]], body)
    close = face_camera([each for group in level for each in group], body, camera)
    projected = [
        project(joints_of(each, body)[:, joint_index("left_eye")], close, 100) for (each,) in level
    ]
    np.testing.assert_allclose(projected[0], projected[1], atol=0.01)
    assert close.field_of_view == face_camera([clip], body, camera).field_of_view
