from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.any_motion import read_motion
from motion.formats.ted_npz import JOINT_NAMES as TEN_JOINTS
from motion.points.clip_from_points import clip_from_points
from motion.skeleton import BODY_JOINTS, JOINT_NAMES, PARENTS, forward_kinematics, joint_index
from renderer.avatars import default_body
from tests.motion.random_clips import random_clip

FloatArray = NDArray[np.float32]
TEN_BONES = [
    ("pelvis", "neck"),
    ("neck", "head"),
    ("head", "jaw"),
    *((f"{side}_shoulder", f"{side}_elbow") for side in ("left", "right")),
    *((f"{side}_elbow", f"{side}_wrist") for side in ("left", "right")),
    *(("neck", f"{side}_shoulder") for side in ("left", "right")),
]


@pytest.fixture(scope="module")
def body() -> BodyModel:
    return read_body(default_body())


@pytest.fixture(scope="module")
def rest(body: BodyModel) -> NDArray[np.float64]:
    return body.joints(np.zeros(0))


@pytest.fixture(scope="module")
def landmarks(body: BodyModel) -> FaceLandmarks:
    return FaceLandmarks.of(body)


def positions(clip: MotionClip, rest: NDArray[np.float64]) -> NDArray[np.float64]:
    return forward_kinematics(clip.poses, clip.trans, rest)[0]


def chosen(
    clip: MotionClip, rest: NDArray[np.float64], names: tuple[str, ...] = TEN_JOINTS
) -> FloatArray:
    index = [joint_index(name) for name in names]
    return positions(clip, rest)[:, index].astype(np.float32)


def degrees(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    across = np.linalg.norm(np.cross(left, right), axis=1)
    return np.degrees(np.arctan2(across, (left * right).sum(axis=1)))


def bones(names: tuple[str, ...]) -> list[tuple[str, str]]:
    tree = [
        (JOINT_NAMES[parent], joint)
        for parent, joint in zip(PARENTS, JOINT_NAMES, strict=True)
        if parent >= 0 and joint in names
    ]
    return TEN_BONES if names == TEN_JOINTS else tree


@settings(max_examples=20)
@given(
    names=st.sampled_from([TEN_JOINTS, BODY_JOINTS, JOINT_NAMES]), seed=st.integers(0, 2**32 - 1)
)
def test_every_bone_of_any_motion_points_where_it_was_told_to(
    names: tuple[str, ...], seed: int, body: BodyModel, rest: NDArray[np.float64]
) -> None:
    clip = random_clip(6, seed=seed)
    clip = replace(clip, poses=clip.poses * 0.8)
    back = clip_from_points(chosen(clip, rest, names), names, 30, body=body)
    before, after = positions(clip, rest), positions(back, rest)
    for start, end in bones(names):
        bone = [all_of[:, joint_index(end)] - all_of[:, joint_index(start)]
                for all_of in (before, after)]  # fmt: skip
        assert degrees(*bone).max() < 0.1, (start, end)


def test_order_of_joints_and_size_of_the_person_do_not_count(
    body: BodyModel, rest: NDArray[np.float64]
) -> None:
    points = chosen(random_clip(5), rest)
    told = clip_from_points(points, TEN_JOINTS, 30, body=body)
    other = clip_from_points(0.7 * points[:, ::-1], TEN_JOINTS[::-1], 30, body=body)
    np.testing.assert_allclose(other.poses, told.poses, atol=1e-4)


def test_what_is_not_told_stands_with_arms_down_and_relaxed_hands(
    body: BodyModel, rest: NDArray[np.float64]
) -> None:
    clip = random_clip(5)
    clip = replace(clip, poses=0.3 * clip.poses)
    needed = ("pelvis", "neck", "left_shoulder", "right_shoulder")
    back = clip_from_points(chosen(clip, rest, needed), needed, 30, body=body)
    after = positions(back, rest)
    hips, feet = (
        after[:, [joint_index(f"{side}_{part}") for side in ("left", "right")]].mean(axis=1)
        for part in ("hip", "foot")
    )
    assert np.ptp(hips, axis=0).max() < 1e-5
    assert np.ptp(feet[:, 1]) < 1e-5
    assert (after[:, joint_index("left_wrist"), 1] < after[:, joint_index("neck"), 1]).all()
    assert np.abs(back.poses[:, joint_index("right_index1")]).max() > 0.1


def test_an_elbow_bends_only_the_way_it_can(body: BodyModel, rest: NDArray[np.float64]) -> None:
    clip = random_clip(5)
    poses = np.zeros_like(clip.poses)
    poses[:, joint_index("left_shoulder")] = [0.4, 0, -1.2]
    poses[:, joint_index("left_elbow")] = [0, -1.3, 0]
    still = replace(clip, poses=poses, trans=np.zeros((5, 3)))
    back = clip_from_points(chosen(still, rest), TEN_JOINTS, 30, body=body)
    np.testing.assert_allclose(
        back.poses[:, joint_index("left_elbow")], poses[:, joint_index("left_elbow")], atol=0.05
    )
    np.testing.assert_allclose(
        back.poses[:, joint_index("left_shoulder")],
        poses[:, joint_index("left_shoulder")],
        atol=0.1,
    )


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_face_comes_back_from_its_landmarks(
    seed: int, body: BodyModel, landmarks: FaceLandmarks, rest: NDArray[np.float64]
) -> None:
    clip = random_clip(6, seed=seed)
    clip = replace(clip, poses=0 * clip.poses)
    shifts = landmarks.shifts(clip)
    back = clip_from_points(
        chosen(random_clip(6), rest), TEN_JOINTS, 30, body=body, landmarks=shifts
    )
    assert back.arkit is not None
    assert back.arkit.min() >= 0 and back.arkit.max() <= 1
    assert np.abs(landmarks.shifts(back) - shifts).max() < 3e-4


def test_facial_actions_are_bounded_least_squares(
    body: BodyModel, landmarks: FaceLandmarks, rest: NDArray[np.float64]
) -> None:
    shifts = np.random.default_rng(1).normal(0, 4e-3, (4, landmarks.count, 3)).astype(np.float32)
    clip = clip_from_points(
        chosen(random_clip(4), rest), TEN_JOINTS, 30, body=body, landmarks=shifts
    )
    assert clip.arkit is not None
    effects = landmarks.body.expression_directions[: landmarks.count].reshape(-1, 52)
    ridge = np.concatenate([effects.astype(float), 3e-4 * np.eye(52)])
    for shift, weights in zip(shifts, clip.arkit, strict=True):
        wanted = np.concatenate([shift.ravel(), np.zeros(52)])
        best = lsq_linear(ridge, wanted, (0, 1))
        cost = 0.5 * float(((ridge @ weights - wanted) ** 2).sum())
        assert cost == pytest.approx(best.cost, rel=1e-4)
        np.testing.assert_allclose(weights, best.x, atol=0.03)


@pytest.mark.parametrize(
    ("file", "frame_rate"), [("2_scott_0_1_1.bvh", 15), ("aitviewer_sample.bvh", None)]
)
def test_a_recording_comes_back_from_ten_joints(
    file: str,
    frame_rate: float | None,
    shared_data: Path,
    body: BodyModel,
    rest: NDArray[np.float64],
) -> None:
    clip = read_motion(shared_data / file, frame_rate=frame_rate)
    back = clip_from_points(chosen(clip, rest), TEN_JOINTS, clip.frame_rate, body=body)
    before, after = positions(clip, rest), positions(back, rest)
    ends = [*bones(TEN_JOINTS), ("right_shoulder", "left_shoulder")]
    for start, end in ends:
        bone = [all_of[:, joint_index(end)] - all_of[:, joint_index(start)]
                for all_of in (before, after)]  # fmt: skip
        assert degrees(*bone).max() < 1.5, (start, end)
    # No twist that was made up moves more suddenly than what was recorded.
    sudden = [np.abs(np.diff(each.poses, 2, axis=0)).max() for each in (clip, back)]
    assert sudden[1] < 1.2 * sudden[0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda p, n: (p[:, :9], n), "joints have shape"),
        (lambda p, n: (p[:0], n), "at least one frame"),
        (lambda p, n: (p[:, 1:], n[1:]), "lack pelvis"),
        (lambda p, n: (p, ("nose", *n[1:])), "unknown joint 'nose'"),
        (lambda p, n: (p, (*n[:-1], n[0])), "named twice"),
        (lambda p, n: (p * np.where(np.arange(10)[:, None] == 3, np.nan, 1), n), "head is no num"),
        (lambda p, n: (1000 * p, n), "Give metres"),
        (lambda p, n: (0 * p, n), "are one point in frame 0"),
    ],
)
def test_what_is_wrong_with_joints_is_said(
    change: object, sentence: str, body: BodyModel, rest: NDArray[np.float64]
) -> None:
    assert callable(change)
    points, names = change(chosen(random_clip(3), rest), TEN_JOINTS)
    with pytest.raises(InputError, match=sentence):
        clip_from_points(points, names, 30, body=body)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda s: s[:, 1:], "landmarks have shape"),
        (lambda s: s[1:], "2 frames of landmarks and 3 of joints"),
        (lambda s: s + np.nan, "landmark 0 is no number in frame 0"),
        (lambda s: 1000 * s, "Give metres"),
    ],
)
def test_what_is_wrong_with_landmarks_is_said(
    change: object,
    sentence: str,
    body: BodyModel,
    landmarks: FaceLandmarks,
    rest: NDArray[np.float64],
) -> None:
    assert callable(change)
    clip = random_clip(3)
    shifts = change(landmarks.shifts(clip))
    with pytest.raises(InputError, match=sentence):
        clip_from_points(chosen(clip, rest), TEN_JOINTS, 30, body=body, landmarks=shifts)


def test_a_body_without_facial_actions_says_so(
    body: BodyModel, landmarks: FaceLandmarks, rest: NDArray[np.float64]
) -> None:
    clip = random_clip(3)
    with pytest.raises(InputError, match="no ARKit facial actions"):
        clip_from_points(
            chosen(clip, rest),
            TEN_JOINTS,
            30,
            body=replace(body, has_arkit_slots=False),
            landmarks=landmarks.shifts(clip),
        )
