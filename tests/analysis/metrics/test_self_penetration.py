from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from analysis.metrics.self_penetration import (
    PenetrableBody,
    sampled_frames,
    self_penetration,
    winding_numbers,
)
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.skeleton import JOINT_COUNT, joint_index
from renderer.look import default_body
from tests.motion.random_clips import clip_of

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


@cache
def body() -> PenetrableBody:
    return PenetrableBody.of(read_body(default_body("mannequin")))


def posed(**turned: tuple[float, float, float]) -> MotionClip:
    poses = np.zeros((30, JOINT_COUNT, 3), np.float32)
    for joint, turn in turned.items():
        poses[:, joint_index(joint)] = turn
    return clip_of(poses)


def test_the_winding_number_is_one_inside_a_closed_surface_and_lower_with_a_hole() -> None:
    points = np.array([[0.5, 0.5, 0.5], [0.01, 0.9, 0.1], [1.5, 0.5, 0.5], [-3.0, 0, 2]])
    found = winding_numbers(points, CUBE, FACES)
    assert found == pytest.approx([1, 1, 0, 0], abs=1e-9)
    with_hole = winding_numbers(points[:1], CUBE, FACES[2:])
    assert with_hole == pytest.approx(5 / 6)


def test_resting_and_stretched_arms_do_not_penetrate() -> None:
    assert not body().depths(posed()).any()
    hanging = posed(left_shoulder=(0, 0, -1.2), right_shoulder=(0, 0, 1.2))
    assert not body().depths(hanging).any()


def test_depth_grows_with_a_hand_in_the_chest() -> None:
    near, far = (
        body().depths(posed(left_shoulder=(0, turn, 0), left_elbow=(0, -3.1 - turn, 0)))
        for turn in (-0.6, -0.3)
    )
    assert len(near) == 2
    assert 0.01 < near[0] < far[0] < 0.12


def test_position_and_body_shape_do_not_matter() -> None:
    inside = posed(left_shoulder=(0, -0.3, 0), left_elbow=(0, -2.8, 0))
    moved = replace(inside, trans=inside.trans + 5, betas=np.ones(10, np.float32))
    assert body().depths(moved) == pytest.approx(body().depths(inside), abs=1e-5)


def test_the_middle_frame_of_each_half_second_is_measured() -> None:
    assert sampled_frames(60, 30.0).tolist() == [7, 22, 37, 52]
    assert sampled_frames(1, 30.0).tolist() == [0]


def test_depth_is_a_mean_in_millimetres_and_shallow_frames_are_not_counted() -> None:
    depth, share = self_penetration(np.array([0, 0.004, 0.02, 0], np.float32), body="some body")
    assert depth.value == pytest.approx(6)
    assert (depth.unit, depth.n) == ("mm", 4)
    assert share.value == 0.25
    assert share.settings["body"] == "some body"
