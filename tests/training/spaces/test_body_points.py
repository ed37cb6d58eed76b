"""Points on the body, against the body layer's own kinematics."""

from __future__ import annotations

import numpy as np
import torch

from motion.body.skinning import skinning_matrices
from motion.clip import MotionClip
from motion.skeleton import REST_JOINTS
from training.spaces.smplx_bodies import BodyPoints, smplx_6d_values


def _clip() -> MotionClip:
    poses = 0.5 * np.random.default_rng(2).standard_normal((4, 55, 3))
    return MotionClip(
        poses=poses.astype(np.float32), trans=np.ones((4, 3), np.float32), frame_rate=30
    )


def test_joints_lie_where_the_body_layer_puts_them_against_the_pelvis() -> None:
    clip = _clip()
    matrices = skinning_matrices(clip.poses, clip.trans, REST_JOINTS)
    rest = np.concatenate([REST_JOINTS, np.ones((55, 1))], axis=1)
    expected = np.einsum("tjrc,jc->tjr", matrices, rest)[..., :3]
    expected = expected - expected[:, :1]
    points = BodyPoints()(torch.from_numpy(smplx_6d_values(clip)).float())
    np.testing.assert_allclose(points[:, :55].numpy(), expected, atol=1e-5)


def test_gradients_reach_every_rotation_that_moves_a_point() -> None:
    values = torch.from_numpy(smplx_6d_values(_clip())).float().requires_grad_()
    BodyPoints()(values).square().sum().backward()
    assert values.grad is not None
    moved = values.grad[:, :330].reshape(-1, 55, 6).abs().amax(dim=(0, 2))
    assert (moved[1:] > 0).all()
