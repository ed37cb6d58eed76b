from __future__ import annotations

import numpy as np

from motion.skeleton import PARENTS, forward_kinematics
from renderer.avatar.smplx_rig import t_pose_joints, unpose


def test_skinning_the_unposed_vertices_gives_the_stance_back() -> None:
    rng = np.random.default_rng(0)
    poses = rng.normal(0, 0.15, (55, 3))
    stance = np.zeros((55, 3))
    for joint, parent in enumerate(PARENTS[1:], start=1):
        stance[joint] = stance[parent] + rng.normal(0, 0.1, 3)
    joints = t_pose_joints(stance, poses)
    weights = rng.random((40, 55)) ** 12
    weights /= weights.sum(axis=1, keepdims=True)
    vertices = rng.normal(0, 0.5, (40, 3))
    template = unpose(vertices, weights, joints, poses, stance)
    shift = stance[0] - joints[0]
    positions, turned = forward_kinematics(poses[None], shift[None], joints)
    np.testing.assert_allclose(positions[0], stance, atol=1e-9)
    offsets = positions[0] - np.einsum("jab,jb->ja", turned[0], joints)
    blended = np.einsum("vj,jab->vab", weights, turned[0])
    again = np.einsum("vab,vb->va", blended, template) + weights @ offsets
    np.testing.assert_allclose(again, vertices, atol=1e-9)
