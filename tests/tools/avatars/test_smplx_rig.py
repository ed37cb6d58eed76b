from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.body.skinning import skinning_matrices
from motion.skeleton import JOINT_COUNT, PARENTS, REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import clip_of
from tools.avatars.smplx_rig import (
    t_pose_joints,
    twist_joints,
    unpose,
    with_twist_joints,
    with_wrists_in_forearms,
)


def _random_weights(count: int, seed: int = 0) -> np.ndarray:
    weights = np.random.default_rng(seed).random((count, JOINT_COUNT)) ** 12
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


@pytest.mark.parametrize("shares_twists", [False, True])
def test_skinning_the_unposed_vertices_gives_the_stance_back(shares_twists: bool) -> None:
    rng = np.random.default_rng(0)
    poses = rng.normal(0, 0.15, (55, 3))
    stance = np.zeros((55, 3))
    for joint, parent in enumerate(PARENTS[1:], start=1):
        stance[joint] = stance[parent] + rng.normal(0, 0.1, 3)
    joints = t_pose_joints(stance, poses)
    vertices = rng.normal(0, 0.5, (40, 3))
    weights = _random_weights(40)
    extra = None
    if shares_twists:
        weights, extra = with_twist_joints(weights, vertices, stance), twist_joints()
    template = unpose(vertices, weights, joints, poses, stance)
    shift = stance[0] - joints[0]
    positions, _ = forward_kinematics(poses[None], shift[None], joints)
    np.testing.assert_allclose(positions[0], stance, atol=1e-9)
    matrices = skinning_matrices(poses[None], shift[None], joints, extra)[0]
    blended = np.einsum("vj,jab->vab", weights, matrices)
    again = np.einsum("vab,vb->va", blended[..., :3], template) + blended[..., 3]
    np.testing.assert_allclose(again, vertices, atol=1e-5)


@pytest.mark.parametrize("change", [with_twist_joints, with_wrists_in_forearms])
def test_weights_shared_out_still_sum_to_one(change: Callable[..., np.ndarray]) -> None:
    vertices = np.random.default_rng(1).normal(0, 0.5, (200, 3))
    weights = _random_weights(200)
    changed = change(weights, vertices, REST_JOINTS)
    assert changed.min() >= 0
    np.testing.assert_allclose(changed.sum(axis=1), 1)
    others = [joint_index(name) for name in ("pelvis", "left_collar", "left_knee", "right_ankle")]
    np.testing.assert_array_equal(changed[:, others], weights[:, others])


def _forearm_thickness(body: BodyModel, joint: str, turned: float) -> np.ndarray:
    """Return the mean squared distance of the left forearm's skin from its bone, slice by slice."""
    elbow, wrist = REST_JOINTS[[joint_index("left_elbow"), joint_index("left_wrist")]]
    poses = np.zeros((1, JOINT_COUNT, 3), np.float32)
    poses[0, joint_index(joint), 0] = np.radians(turned)
    clip = clip_of(poses)
    place = (body.template[:, 0] - elbow[0]) / (wrist[0] - elbow[0])
    near = np.linalg.norm((body.template - elbow)[:, 1:], axis=1) < 0.12
    offsets = (body.vertices(clip)[0] - elbow)[:, 1:]
    squared = (offsets**2).sum(axis=1)
    edges = np.linspace(0.1, 0.95, 9)
    return np.array(
        [
            squared[near & (place >= low) & (place < high)].mean()
            for low, high in itertools.pairwise(edges)
        ]
    )


@pytest.mark.parametrize("joint", ["left_wrist", "left_elbow"])
@pytest.mark.parametrize("turned", [-120, 120])
def test_the_default_bodys_twisted_forearm_keeps_its_thickness(
    body: BodyModel, joint: str, turned: float
) -> None:
    straight = _forearm_thickness(body, joint, 0)
    assert (_forearm_thickness(body, joint, turned) / straight).min() > 0.85
