"""Motion in networks' terms and back."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from scipy.spatial.transform import Rotation

from generators.diffsheg.config import BEAT
from generators.diffsheg.network_file import read_normalisation
from motion.body.skinning import skinning_matrices
from motion.clip import ARKIT_NAMES, MotionClip
from motion.errors import InputError
from motion.formats.bvh import read_bvh
from motion.formats.bvh_motion import BvhMotion, settle_first_frame
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget
from motion.formats.ted_npz import BONES
from motion.formats.ted_npz import JOINT_NAMES as TED_JOINTS
from motion.placement import place
from motion.skeleton import (
    JOINT_COUNT,
    JOINT_NAMES,
    RELAXED_HANDS,
    REST_JOINTS,
    forward_kinematics,
    joint_index,
)
from tests.generators.s2ue.small_network import FACE
from tests.motion.random_clips import arkit_of, clip_of
from training.spaces.beat import (
    FACIAL_WEIGHTS,
    UPPER_BODY_JOINTS,
    beat_clip,
    beat_clip_piece,
    body_values,
    face_values,
    upper_body_motion,
)
from training.spaces.bones_and_landmarks import (
    BONE_LENGTHS,
    BONE_VALUES,
    bone_and_landmark_clip,
    bone_and_landmark_values,
    joint_tensors,
    joints_from_directions,
    with_units,
)
from training.spaces.smplx_bodies import (
    WIDTH,
    BodyPoints,
    show_clip,
    show_values,
    smplx_6d_clip,
    smplx_6d_values,
)


@pytest.fixture(scope="module")
def recording(shared_data: Path) -> BvhMotion:
    whole = settle_first_frame(read_bvh(shared_data / "2_scott_0_1_1.bvh", frame_rate=15))
    return replace(whole, values=whole.values[:150])


def with_still_face(body: np.ndarray) -> np.ndarray:
    return np.concatenate([body, np.zeros((len(body), 51))], axis=1)


def degrees_apart(one: MotionClip, other: MotionClip) -> dict[str, float]:
    turns = [Rotation.from_rotvec(clip.poses.reshape(-1, 3)) for clip in (one, other)]
    angles = np.degrees((turns[0].inv() * turns[1]).magnitude()).reshape(-1, len(JOINT_NAMES))
    return dict(zip(JOINT_NAMES, angles.max(axis=0), strict=True))


def test_a_recording_fits_the_released_means_and_deviations(
    recording: BvhMotion, shared_data: Path
) -> None:
    known = read_normalisation(shared_data / "diffsheg_stats", BEAT)
    body = body_values(recording)
    faces = np.tile(known.mean[141:], (len(body), 1))
    right = known.normalised(np.concatenate([body, faces], axis=1))[:, :141]
    order = np.random.default_rng(1).permutation(47)
    shuffled = body.reshape(-1, 47, 3)[:, order].reshape(-1, 141)
    wrong = known.normalised(np.concatenate([shuffled, faces], axis=1))[:, :141]
    assert np.sqrt((right**2).mean()) < 1
    assert np.sqrt((wrong**2).mean()) > 3


def test_a_recording_moves_alike_on_the_idealised_skeleton(recording: BvhMotion) -> None:
    _, joint_map = choose_joint_map(recording.joint_names)
    known, _ = place(retarget(recording, joint_map))
    angles = degrees_apart(known, beat_clip(with_still_face(body_values(recording)), 15))
    fingers = ("index", "middle", "pinky", "ring", "thumb")
    assert max(v for k, v in angles.items() if not any(f in k for f in fingers)) < 0.1
    assert max(angles.values()) < 2
    other = replace(recording, joints=recording.joints[:4], values=recording.values[:, :15])
    with pytest.raises(InputError, match="not BEAT's: it lacks"):
        body_values(other)


def test_values_survive_a_round_trip_through_axis_angles() -> None:
    rng = np.random.default_rng(2)
    body = rng.uniform(-1.5, 1.5, (20, 141))
    # At a right angle about y several angles mean the same turn.
    body[0] = 0
    body[0, 3 * UPPER_BODY_JOINTS.index("RightForeArm") + 1] = np.pi / 2
    np.testing.assert_allclose(body_values(upper_body_motion(body, 15)), body, atol=1e-7)


def test_the_zero_pose_stands_upright_with_level_arms() -> None:
    clip = beat_clip(np.zeros((1, 192)), 15)
    joints, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    at = {name: joints[0, joint_index(name)] for name in JOINT_NAMES}
    for side, sign in (("left", 1), ("right", -1)):
        arm = at[f"{side}_wrist"] - at[f"{side}_shoulder"]
        assert arm[0] * sign / np.linalg.norm(arm) > 0.99
    assert at["head"][1] - at["left_ankle"][1] > 1.3
    assert at["left_ankle"][1] == pytest.approx(REST_JOINTS[joint_index("left_ankle")][1], abs=0.02)


def test_facial_weights_are_arkits_and_stay_in_range() -> None:
    values = np.zeros((2, 192))
    for name, weight in (("jawOpen", 0.4), ("browInnerUp", 1.7), ("mouthClose", -0.3)):
        values[:, 141 + FACIAL_WEIGHTS.index(name)] = weight
    arkit = arkit_of(beat_clip(values, 15))
    assert arkit[0, ARKIT_NAMES.index("jawOpen")] == pytest.approx(0.4)
    assert arkit[0, ARKIT_NAMES.index("browInnerUp")] == 1
    assert arkit[0, ARKIT_NAMES.index("mouthClose")] == 0
    assert arkit.sum() == pytest.approx(2 * 1.4)
    assert face_values(arkit).shape == (2, 51)


@pytest.mark.parametrize("cuts", [[30, 60], [1, 2, 50]])
def test_chunks_equal_the_whole_motion_even_if_forearms_twist_past_half_a_turn(
    cuts: list[int],
) -> None:
    body = np.zeros((80, 47, 3))
    body[:, UPPER_BODY_JOINTS.index("RightForeArm"), 0] = np.linspace(0, 8, 80)
    body[:, UPPER_BODY_JOINTS.index("LeftHand"), 0] = np.linspace(3, -5, 80)
    values = with_still_face(body.reshape(80, 141))
    whole = beat_clip(values, 15)
    pieces, before = [], None
    for part in np.split(values, cuts):
        piece, before = beat_clip_piece(part, 15, before)
        pieces.append(piece)
    assert before is not None
    assert before.turns.any()
    np.testing.assert_array_equal(np.concatenate([one.poses for one in pieces]), whole.poses)
    np.testing.assert_array_equal(np.concatenate([one.trans for one in pieces]), whole.trans)


def clip(turned: float = 0.0) -> MotionClip:
    poses = np.zeros((5, JOINT_COUNT, 3))
    poses[:, joint_index("left_shoulder")] = [0, 0, -1.0]
    poses[:, joint_index("right_elbow"), 1] = np.linspace(0.5, 1.5, 5)
    poses[:, 0] = (Rotation.from_euler("y", turned)).as_rotvec()
    arkit = np.zeros((5, 52))
    arkit[:, ARKIT_NAMES.index("jawOpen")] = np.linspace(0, 0.8, 5)
    return clip_of(poses, np.ones((5, 3)), 15, arkit=arkit)


def test_joints_are_rebuilt_from_unit_directions() -> None:
    values = bone_and_landmark_values(clip(), FACE)
    assert values.shape == (5, BONE_VALUES + 3 * FACE.count)
    np.testing.assert_allclose(values[0, BONE_VALUES:], 0, atol=1e-7)
    again = bone_and_landmark_values(bone_and_landmark_clip(values, 15.0, FACE), FACE)
    arms = np.arange(BONE_VALUES).reshape(-1, 3)[[4, 5, 7, 8]].ravel()
    np.testing.assert_allclose(again[:, arms], values[:, arms], atol=0.02)
    np.testing.assert_allclose(again[:, BONE_VALUES:], values[:, BONE_VALUES:], atol=2e-3)
    directions = values[:, :BONE_VALUES].reshape(5, len(BONES), 3)
    np.testing.assert_allclose(np.linalg.norm(directions, axis=-1), 1)
    joints = forward_kinematics(clip().poses, np.zeros((5, 3)), REST_JOINTS)[0]
    expected = joints[:, [joint_index(name) for name in TED_JOINTS]] - joints[:, :1]
    np.testing.assert_allclose(joints_from_directions(directions), expected, atol=1e-6)
    np.testing.assert_allclose(joints_from_directions(3 * directions), expected, atol=1e-6)
    np.testing.assert_allclose(BONE_LENGTHS[4:6], [0.2713, 0.2522], atol=1e-4)
    tensors = joint_tensors(torch.from_numpy(3 * directions)).numpy()
    np.testing.assert_allclose(tensors, expected, atol=1e-6)
    stretched = torch.from_numpy(values * np.repeat([3, 1], [BONE_VALUES, 3 * FACE.count]))
    np.testing.assert_allclose(with_units(stretched).numpy(), values, atol=1e-6)
    turned = bone_and_landmark_values(clip(2.0), FACE)
    np.testing.assert_allclose(turned, values, atol=1e-6)


def _clip() -> MotionClip:
    random = np.random.default_rng(5)
    poses = 0.4 * random.standard_normal((6, 55, 3))
    poses[:, 0] = 0
    return place(clip_of(poses))[0]


def test_a_clip_is_recovered_from_scaled_first_two_matrix_rows() -> None:
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
        assert max(degrees_apart(clip, result).values()) < np.degrees(1e-5)
        assert result.trans == pytest.approx(clip.trans, abs=1e-5)


RNG = np.random.default_rng(8)


def test_values_survive_a_round_trip_with_relaxed_hands() -> None:
    values = RNG.normal(0, 0.2, (5, 232))
    expected = values.copy()
    expected[:, 39:129] += RELAXED_HANDS.reshape(-1)
    np.testing.assert_allclose(show_values(show_clip(values, 30)), expected, atol=1e-6)


@pytest.mark.parametrize(
    ("column", "joint"),
    [(0, "spine1"), (9, "neck"), (18, "head"), (27, "left_elbow"), (36, "right_wrist"),
     (129, "jaw")],
)  # fmt: skip
def test_each_value_rotates_only_its_own_joint(column: int, joint: str) -> None:
    values = np.zeros((1, 232))
    values[0, column] = 0.5
    clip, still = show_clip(values, 30), show_clip(np.zeros((1, 232)), 30)
    changed = np.flatnonzero((clip.poses != still.poses).any(axis=(0, 2)))
    assert [JOINT_NAMES[index] for index in changed] == [joint]


def test_joint_positions_match_the_body_layer_relative_to_the_pelvis() -> None:
    clip = _clip()
    matrices = skinning_matrices(clip.poses, clip.trans, REST_JOINTS)
    rest = np.concatenate([REST_JOINTS, np.ones((55, 1))], axis=1)
    expected = np.einsum("tjrc,jc->tjr", matrices, rest)[..., :3]
    expected = expected - expected[:, :1]
    points = BodyPoints()(torch.from_numpy(smplx_6d_values(clip)).float())
    np.testing.assert_allclose(points[:, :55].numpy(), expected, atol=1e-5)
