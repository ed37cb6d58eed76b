"""A whole body as continuous numbers."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from motion.body.skinning import skinning_matrices
from motion.clip import MotionClip
from motion.placement import place
from motion.skeleton import JOINT_NAMES, RELAXED_HANDS, REST_JOINTS
from training.spaces.smplx_bodies import (
    WIDTH,
    BodyPoints,
    show_clip,
    show_values,
    smplx_6d_clip,
    smplx_6d_values,
)


def _clip() -> MotionClip:
    random = np.random.default_rng(5)
    poses = 0.4 * random.standard_normal((6, 55, 3))
    poses[:, 0] = 0
    clip = MotionClip(
        poses=poses.astype(np.float32), trans=np.zeros((6, 3), np.float32), frame_rate=30
    )
    return place(clip)[0]


def _turns(clip: MotionClip) -> Rotation:
    return Rotation.from_rotvec(clip.poses.reshape(-1, 3))


def test_a_clip_comes_back_from_the_first_two_rows_of_its_matrices_also_stretched() -> None:
    clip = _clip()
    values = smplx_6d_values(clip)
    assert values.shape == (6, WIDTH)
    matrix = Rotation.from_rotvec(clip.poses[2, 16]).as_matrix()
    assert values[2, 6 * 16 : 6 * 17] == pytest.approx(matrix[:2].ravel())
    stretched = values.copy()
    rows = stretched[:, :330].reshape(6, 55, 2, 3)
    rows[..., 1, :] += 0.3 * rows[..., 0, :]
    rows *= 1.7
    for result in (smplx_6d_clip(values, 30), smplx_6d_clip(stretched, 30)):
        assert (_turns(clip).inv() * _turns(result)).magnitude().max() < 1e-5
        assert result.trans == pytest.approx(clip.trans, abs=1e-5)


RNG = np.random.default_rng(8)


def test_values_come_back_with_the_relaxed_hands_added() -> None:
    values = RNG.normal(0, 0.2, (5, 232))
    expected = values.copy()
    expected[:, 39:129] += RELAXED_HANDS.reshape(-1)
    np.testing.assert_allclose(show_values(show_clip(values, 30)), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("column", "joint"),
    [(0, "spine1"), (9, "neck"), (18, "head"), (27, "left_elbow"), (36, "right_wrist"),
     (129, "jaw")],
)  # fmt: skip
def test_each_value_turns_its_joint_and_no_other(column: int, joint: str) -> None:
    values = np.zeros((1, 232))
    values[0, column] = 0.5
    clip, still = show_clip(values, 30), show_clip(np.zeros((1, 232)), 30)
    changed = np.flatnonzero((clip.poses != still.poses).any(axis=(0, 2)))
    assert [JOINT_NAMES[index] for index in changed] == [joint]


def test_joints_lie_where_the_body_layer_puts_them_against_the_pelvis() -> None:
    clip = _clip()
    matrices = skinning_matrices(clip.poses, clip.trans, REST_JOINTS)
    rest = np.concatenate([REST_JOINTS, np.ones((55, 1))], axis=1)
    expected = np.einsum("tjrc,jc->tjr", matrices, rest)[..., :3]
    expected = expected - expected[:, :1]
    points = BodyPoints()(torch.from_numpy(smplx_6d_values(clip)).float())
    np.testing.assert_allclose(points[:, :55].numpy(), expected, atol=1e-5)
