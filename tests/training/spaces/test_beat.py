"""BEAT's joint rotations to our body and back."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from generators.diffsheg.config import BEAT
from generators.diffsheg.network_file import read_normalisation
from motion.clip import ARKIT_NAMES, MotionClip
from motion.formats.bvh import read_bvh
from motion.formats.bvh_motion import BvhMotion, settle_first_frame
from motion.formats.joint_maps import choose_joint_map
from motion.formats.retarget import retarget
from motion.placement import place
from motion.skeleton import JOINT_NAMES, REST_JOINTS, forward_kinematics, joint_index
from training.spaces.beat import (
    FACIAL_WEIGHTS,
    UPPER_BODY_JOINTS,
    beat_clip,
    beat_clip_piece,
    body_values,
    face_values,
    upper_body_motion,
)

DATA = Path(__file__).parents[4] / "shared" / "data"


@pytest.fixture(scope="module")
def recording() -> BvhMotion:
    path = DATA / "2_scott_0_1_1.bvh"
    if not path.exists():
        pytest.skip("the recording of BEAT is not here")
    whole = settle_first_frame(read_bvh(path, frame_rate=15))
    return replace(whole, values=whole.values[:150])


def with_still_face(body: np.ndarray) -> np.ndarray:
    return np.concatenate([body, np.zeros((len(body), 51))], axis=1)


def degrees_apart(one: MotionClip, other: MotionClip) -> dict[str, float]:
    turns = [Rotation.from_rotvec(clip.poses.reshape(-1, 3)) for clip in (one, other)]
    angles = np.degrees((turns[0].inv() * turns[1]).magnitude()).reshape(-1, len(JOINT_NAMES))
    return dict(zip(JOINT_NAMES, angles.max(axis=0), strict=True))


def test_the_recording_lies_where_the_released_means_and_deviations_say(
    recording: BvhMotion,
) -> None:
    if not (DATA / "diffsheg_stats").exists():
        pytest.skip("the released means are not here")
    known = read_normalisation(DATA / "diffsheg_stats", BEAT)
    body = body_values(recording)
    faces = np.tile(known.mean[141:], (len(body), 1))
    right = known.normalised(np.concatenate([body, faces], axis=1))[:, :141]
    order = np.random.default_rng(1).permutation(47)
    shuffled = body.reshape(-1, 47, 3)[:, order].reshape(-1, 141)
    wrong = known.normalised(np.concatenate([shuffled, faces], axis=1))[:, :141]
    assert np.sqrt((right**2).mean()) < 1
    assert np.sqrt((wrong**2).mean()) > 3


def test_the_recording_comes_back_as_it_was_on_its_own_skeleton(recording: BvhMotion) -> None:
    _, joint_map = choose_joint_map(recording.joint_names)
    known, _ = place(retarget(recording, joint_map))
    result = beat_clip(with_still_face(body_values(recording)), 15, recording.joints)
    assert max(degrees_apart(known, result).values()) < 0.1
    assert np.abs(known.trans - result.trans).max() < 1e-3


def test_the_idealised_skeleton_moves_as_the_speakers_own(recording: BvhMotion) -> None:
    values = with_still_face(body_values(recording))
    angles = degrees_apart(beat_clip(values, 15, recording.joints), beat_clip(values, 15))
    fingers = ("index", "middle", "pinky", "ring", "thumb")
    assert max(v for k, v in angles.items() if not any(f in k for f in fingers)) < 0.1
    assert max(angles.values()) < 2


def test_values_survive_the_way_over_angles_about_axes() -> None:
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


def test_facial_weights_are_arkits_and_stay_weights() -> None:
    values = np.zeros((2, 192))
    for name, weight in (("jawOpen", 0.4), ("browInnerUp", 1.7), ("mouthClose", -0.3)):
        values[:, 141 + FACIAL_WEIGHTS.index(name)] = weight
    arkit = beat_clip(values, 15).arkit
    assert arkit is not None
    assert arkit[0, ARKIT_NAMES.index("jawOpen")] == pytest.approx(0.4)
    assert arkit[0, ARKIT_NAMES.index("browInnerUp")] == 1
    assert arkit[0, ARKIT_NAMES.index("mouthClose")] == 0
    assert arkit.sum() == pytest.approx(2 * 1.4)
    assert face_values(arkit).shape == (2, 51)


@pytest.mark.parametrize("cuts", [[30, 60], [1, 2, 50]])
def test_pieces_are_the_whole_motion_also_where_forearms_twist_past_half_a_turn(
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
