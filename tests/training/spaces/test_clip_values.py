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
from training.spaces.normalisation import Normalisation
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


def test_a_clip_comes_back_from_its_values() -> None:
    clip = _clip()
    values = smplx_6d_values(clip)
    back = smplx_6d_clip(values, 30)
    assert values.shape == (6, WIDTH)
    assert (_turns(clip).inv() * _turns(back)).magnitude().max() < 1e-5
    assert back.trans == pytest.approx(clip.trans, abs=1e-5)


def test_values_are_orthonormalised_from_their_first_row() -> None:
    clip = _clip()
    values = smplx_6d_values(clip)
    stretched = values.copy()
    rows = stretched[:, :330].reshape(6, 55, 2, 3)
    rows[..., 1, :] += 0.3 * rows[..., 0, :]
    rows *= 1.7
    back = smplx_6d_clip(stretched, 30)
    assert (_turns(clip).inv() * _turns(back)).magnitude().max() < 1e-5


def test_the_first_two_rows_of_a_rotation_matrix_are_kept() -> None:
    clip = _clip()
    matrix = Rotation.from_rotvec(clip.poses[2, 16]).as_matrix()
    assert smplx_6d_values(clip)[2, 6 * 16 : 6 * 17] == pytest.approx(matrix[:2].ravel())


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


def test_normalised_motion_is_restored() -> None:
    rng = np.random.default_rng(1)
    motion = rng.normal(3, 2, (50, 4))
    known = Normalisation(motion.mean(axis=0), motion.std(axis=0))
    normalised = known.normalised(motion)
    assert normalised.mean(axis=0) == pytest.approx(0, abs=1e-9)
    assert normalised.std(axis=0) == pytest.approx(1)
    np.testing.assert_allclose(known.restored(normalised), motion)


def _swaying() -> MotionClip:
    poses = 0.5 * np.random.default_rng(2).standard_normal((4, 55, 3))
    return MotionClip(
        poses=poses.astype(np.float32), trans=np.ones((4, 3), np.float32), frame_rate=30
    )


def test_joints_lie_where_the_body_layer_puts_them_against_the_pelvis() -> None:
    clip = _swaying()
    matrices = skinning_matrices(clip.poses, clip.trans, REST_JOINTS)
    rest = np.concatenate([REST_JOINTS, np.ones((55, 1))], axis=1)
    expected = np.einsum("tjrc,jc->tjr", matrices, rest)[..., :3]
    expected = expected - expected[:, :1]
    points = BodyPoints()(torch.from_numpy(smplx_6d_values(clip)).float())
    np.testing.assert_allclose(points[:, :55].numpy(), expected, atol=1e-5)


def test_gradients_reach_every_rotation_that_moves_a_point() -> None:
    values = torch.from_numpy(smplx_6d_values(_swaying())).float().requires_grad_()
    BodyPoints()(values).square().sum().backward()
    assert values.grad is not None
    moved = values.grad[:, :330].reshape(-1, 55, 6).abs().amax(dim=(0, 2))
    assert (moved[1:] > 0).all()
