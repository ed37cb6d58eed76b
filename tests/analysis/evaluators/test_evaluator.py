import hashlib
import json
import pickle
from dataclasses import replace
from functools import reduce
from operator import getitem
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.evaluators.clip_views import ClipView, face_of
from analysis.evaluators.evaluator import Evaluator, load_evaluator
from analysis.evaluators.feature_networks import networks
from motion.clip import freeze
from motion.errors import InputError
from motion.resample import resample
from motion.skeleton import joint_index
from tests.analysis.evaluators.swinging import SWINGS, swinging
from tests.motion.random_clips import random_clip
from training.weights_file import read_weights, write_weights


def test_each_window_of_a_clip_of_any_rate_has_an_embedding_of_its_own(
    emotion: Evaluator, gesture: Evaluator
) -> None:
    clip = swinging("anger", 90, seconds=10)
    assert emotion.embed(clip).shape == (2, 64)
    whole = gesture.embed(clip)
    assert whole.shape == (4, 32)
    third = gesture.embed(resample(clip, 15).frames(slice(68, 102)))
    np.testing.assert_allclose(whole[2:3], third, atol=1e-5)
    assert not np.allclose(whole[0], whole[1], atol=1e-3)


def test_emotions_of_unseen_clips_are_recognised(emotion: Evaluator) -> None:
    assert emotion.labels == ("anger", "sadness")
    for number, label in enumerate(SWINGS):
        shares = emotion.classify(swinging(label, 91, seconds=16))
        np.testing.assert_allclose(shares.sum(axis=1), 1, atol=1e-5)
        assert (shares.argmax(axis=1) == number).all()


def test_a_clip_shorter_than_a_window_says_so(gesture: Evaluator) -> None:
    with pytest.raises(InputError, match=r"lasts 2\.00 s .* windows of 2\.27 s"):
        gesture.embed(swinging("anger", 90, seconds=2))
    assert len(gesture.embed(swinging("anger", 90, seconds=33 / 15))) == 1


def test_channels_frozen_in_training_clips_stay_frozen(both_file: Path) -> None:
    both = load_evaluator(both_file)
    clip = swinging("anger", 90)
    assert both.describe()["held still"] == "hands"
    np.testing.assert_array_equal(both.embed(clip), both.embed(freeze(clip, ["hands"])))


def test_a_clip_without_a_face_says_what_is_missing(both_file: Path, face_file: Path) -> None:
    faceless = replace(swinging("anger", 90), arkit=None)
    for path in (both_file, face_file):
        with pytest.raises(InputError, match=r"no .*ARKit weights|ARKit weights.*"):
            load_evaluator(path).embed(faceless)


def test_landmarks_are_stored_in_the_file_and_follow_the_face(face_file: Path) -> None:
    face = load_evaluator(face_file)
    clip = swinging("anger", 90)
    still = replace(clip, arkit=np.zeros_like(clip.arkit))
    facts = face.facts
    assert (facts.kind, facts.channels, face.embed(clip).shape[1]) == ("face", "landmarks", 32)
    assert not np.allclose(face.embed(clip), face.embed(still), atol=1e-3)
    turned = replace(clip, poses=np.where(np.arange(55)[:, None] == 15, 0.3, clip.poses))
    np.testing.assert_allclose(face.embed(clip), face.embed(turned), atol=1e-6)


def test_every_setting_that_a_score_depends_on_is_listed(
    emotion: Evaluator, emotion_file: Path
) -> None:
    told = emotion.describe()
    sha256 = hashlib.sha256(emotion_file.read_bytes()).hexdigest()
    assert emotion.sha256 == sha256
    assert told["network sha256"] == sha256[:16]
    assert told["representation"].startswith("47 joints, 6D")
    assert told["frame rate"].startswith("15 fps")
    assert told["window"].startswith("60 frames (4 s)")
    assert told["trained on"].startswith("10 clips of 10 recordings")
    assert "2 of 10 recordings: accuracy" in told["held out"]
    assert all(isinstance(value, str) and value for value in told.values())
    (network,) = networks([emotion_file])
    assert network.settings == told
    # It travels to the processes that measure.
    assert pickle.loads(pickle.dumps(network)) == network  # noqa: S301


@pytest.mark.parametrize(
    ("keys", "value"),
    [
        (("format",), 1),
        (("channels",), "dance"),
        (("channels",), "gesture"),
        (("labels",), ["anger", "fear", "sadness"]),
        (("network", "width"), 128),
        (("network", "heads"), 7),
        (("held_out",), {"accuracy": "good"}),
    ],
)
def test_a_file_whose_weights_do_not_fit_its_header_is_refused(
    keys: tuple[str, ...], value: object, emotion_file: Path, tmp_path: Path
) -> None:
    file = read_weights(emotion_file)
    facts = json.loads(json.dumps(dict(file.facts)))
    *outer, last = keys
    reduce(getitem, outer, facts)[last] = value
    path = tmp_path / "changed.safetensors"
    write_weights(path, file.tensors, facts)
    with pytest.raises(InputError, match="not of a feature network of this version") as refused:
        load_evaluator(path)
    assert refused.value.where == str(path)
    assert refused.value.remedy


def test_a_file_that_is_not_a_feature_network_is_refused(emotion_file: Path) -> None:
    checkpoint = emotion_file.with_suffix(".run") / "checkpoint.safetensors"
    with pytest.raises(InputError, match="not of a feature network"):
        load_evaluator(checkpoint)


def test_rotations_are_two_columns_of_their_matrices_and_the_face_follows() -> None:
    clip = random_clip(3)
    view = ClipView(joints=("neck",), face="expressions")
    seen = view.frames(clip)
    turn = Rotation.from_rotvec(clip.poses[2, joint_index("jaw")]).as_matrix()
    np.testing.assert_allclose(seen[2, 6:12], turn[:, :2].T.ravel(), atol=1e-6)
    np.testing.assert_array_equal(seen[:, 12:], clip.expressions)
    assert view.channels == view.floor.size == seen.shape[1]


def test_a_face_in_other_parameters_is_refused() -> None:
    clip = random_clip(3)
    with pytest.raises(InputError, match="no SMPL-X expression coefficients"):
        ClipView(face="expressions").frames(replace(clip, expressions=None))
    assert face_of(clip) == "arkit"
    assert face_of(replace(clip, arkit=None)) == "expressions"
    with pytest.raises(InputError, match="no face"):
        face_of(random_clip(3, face=False))
