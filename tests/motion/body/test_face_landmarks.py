from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.body.face_landmarks import FaceLandmarks, landmark_vertices
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.motion.random_clips import random_clip

JAW = joint_index("jaw")


@pytest.fixture(scope="module")
def landmarks(body: BodyModel) -> FaceLandmarks:
    return FaceLandmarks.of(body)


def face_alone(clip: MotionClip) -> MotionClip:
    poses = np.zeros_like(clip.poses)
    poses[:, JAW] = clip.poses[:, JAW]
    return replace(clip, poses=poses, trans=np.zeros_like(clip.trans), betas=clip.betas[:0])


@pytest.mark.parametrize("licensed", [False, True])
def test_landmarks_match_the_vertices_of_the_whole_body(body: BodyModel, licensed: bool) -> None:
    if licensed:
        shape = (len(body.template), 3, 486)
        poses = np.random.default_rng(0).normal(0, 1e-3, shape).astype(np.float32)
        body = replace(body, has_arkit_slots=False, surface={}, pose_directions=poses)
    clip, landmarks = random_clip(9), FaceLandmarks.of(body)
    whole = body.vertices(face_alone(clip))[:, landmark_vertices(body)]
    np.testing.assert_allclose(landmarks.positions(clip), whole, atol=1e-6)
    np.testing.assert_allclose(landmarks.shifts(clip), whole - landmarks.neutral, atol=1e-6)


def test_missing_arrays_are_refused(landmarks: FaceLandmarks) -> None:
    arrays = landmarks.arrays()
    with pytest.raises(InputError, match="lack 'weights'"):
        FaceLandmarks.from_arrays({key: arrays[key] for key in arrays if key != "weights"})


def test_unshowable_faces_and_bodies_without_a_face_are_refused(
    landmarks: FaceLandmarks, body: BodyModel
) -> None:
    with pytest.raises(InputError, match="ARKit weights"):
        landmarks.shifts(replace(random_clip(4), arkit=None))
    faceless = replace(body, expression_directions=body.expression_directions[:, :, :0])
    with pytest.raises(InputError, match="no face that moves"):
        FaceLandmarks.of(faceless)


def test_the_stored_landmarks_match_the_default_body(landmarks: FaceLandmarks) -> None:
    frozen = FaceLandmarks.of_default_body()
    for name, array in landmarks.arrays().items():
        same = np.asarray(frozen.arrays()[name], float)
        np.testing.assert_allclose(same, np.asarray(array, float), atol=1e-6)


@settings(max_examples=10)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_face_is_recovered_from_its_landmarks(landmarks: FaceLandmarks, seed: int) -> None:
    clip = random_clip(6, seed=seed)
    clip = replace(clip, poses=0 * clip.poses)
    shifts = landmarks.shifts(clip)
    back = replace(clip, arkit=landmarks.facial_actions(shifts))
    assert np.abs(landmarks.shifts(back) - shifts).max() < 3e-4


def test_landmarks_are_named_by_their_facial_actions(landmarks: FaceLandmarks) -> None:
    assert len(landmarks.actions) == landmarks.count
    chin, left, right = (
        landmarks.neutral[landmarks.actions.index(action)]
        for action in ("jawOpen", "mouthSmileLeft", "mouthSmileRight")
    )
    assert chin[1] < left[1]
    assert left[0] > 0 > right[0]
