from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.body.skinning import skinning_matrices
from motion.clip import arkit_index
from motion.skeleton import JOINT_COUNT, PARENTS, REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import clip_of
from tools.avatars.sample_poses import FIST, SAMPLE_POSES, SamplePose, sample_clip
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


def _limb_shape(turned: float, *, shares_twists: bool) -> float:
    """Return the smallest share of a forearm's cross-section that a twisted wrist leaves."""
    elbow, wrist = joint_index("left_elbow"), joint_index("left_wrist")
    around = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    ring = 0.03 * np.stack([0 * around, np.cos(around), np.sin(around)], axis=1)
    along = np.linspace(REST_JOINTS[elbow], REST_JOINTS[wrist], 30)
    vertices = (along[:, None] + ring).reshape(-1, 3)
    weights = np.zeros((len(vertices), JOINT_COUNT))
    share = np.clip((np.repeat(along[:, 0], 24) - REST_JOINTS[wrist, 0] + 0.04) / 0.04, 0, 1)
    weights[:, elbow], weights[:, wrist] = 1 - share, share
    poses = np.zeros((1, JOINT_COUNT, 3))
    poses[0, wrist, 0] = np.radians(turned)
    if shares_twists:
        shared, extra = with_twist_joints(weights, vertices, REST_JOINTS), twist_joints()
    else:
        shared, extra = with_wrists_in_forearms(weights, vertices, REST_JOINTS), None
    matrices = skinning_matrices(poses, np.zeros((1, 3)), REST_JOINTS, extra)[0]
    blended = np.einsum("vj,jab->vab", shared, matrices)
    moved = np.einsum("vab,vb->va", blended[..., :3], vertices) + blended[..., 3]
    radius = np.linalg.norm(moved - along.repeat(24, axis=0), axis=1).reshape(30, 24)
    return float(((radius / 0.03) ** 2).mean(axis=1).min())


@pytest.mark.parametrize("turned", [-120, -60, 60, 120])
def test_a_twisted_forearm_keeps_its_thickness(turned: float) -> None:
    assert _limb_shape(turned, shares_twists=True) > 0.85


def test_without_twist_joints_a_twisted_forearm_is_wrung() -> None:
    assert _limb_shape(120, shares_twists=False) < 0.5


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


def _joints(name: str) -> np.ndarray:
    clip = sample_clip(SAMPLE_POSES[name])
    return np.asarray(forward_kinematics(clip.poses, clip.trans, REST_JOINTS)[0][0])


def test_there_are_a_dozen() -> None:
    assert len(SAMPLE_POSES) == 12


def test_arms_hang_where_a_pose_says_nothing_of_them() -> None:
    joints = _joints("jaw open")
    for side in ("left", "right"):
        wrist, shoulder = (joints[joint_index(f"{side}_{part}")] for part in ("wrist", "shoulder"))
        assert wrist[1] < shoulder[1] - 0.4


def test_both_sides_are_mirror_images() -> None:
    joints = _joints("fists")
    left, right = (joints[joint_index(f"{side}_wrist")] for side in ("left", "right"))
    np.testing.assert_allclose(left * [-1, 1, 1], right, atol=1e-6)


@pytest.mark.parametrize("side", ["left", "right"])
def test_crossed_arms_reach_the_other_side_in_front_of_the_body(side: str) -> None:
    hand = _joints("arms crossed")[joint_index(f"{side}_middle3")]
    assert hand[0] * (1 if side == "left" else -1) < 0
    assert hand[2] > 0.1


def test_one_finger_can_be_bent_otherwise_than_the_rest() -> None:
    pose = SamplePose(curled={"right": FIST, "right_index": 0.1})
    poses = sample_clip(pose).poses[0]
    assert poses[joint_index("right_ring2"), 2] == pytest.approx(FIST)
    assert poses[joint_index("right_index2"), 2] == pytest.approx(0.1)


def test_a_face_named_for_both_sides_moves_both() -> None:
    arkit = sample_clip(SamplePose(face={"eyeBlinkBoth": 0.7})).arkit
    assert arkit is not None
    chosen = [arkit_index("eyeBlinkLeft"), arkit_index("eyeBlinkRight")]
    np.testing.assert_allclose(arkit[0, chosen], 0.7)
    assert arkit.sum() == pytest.approx(1.4)
