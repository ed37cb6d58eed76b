"""Networks' features, computed from files as in the data sets."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from generators.diffsheg.train import training_features
from motion.audio import read_audio, write_wav
from motion.errors import InputError
from motion.formats.ted_npz import AXES
from tests.generators.s2ue.small_network import FACE, standing
from tests.support.fingerprint import fingerprint
from tests.support.sounds import noise
from tests.training.data.recordings import (
    DOWN,
    write_beat_motion,
    write_beat_take,
    write_clicks,
    write_smplx,
)
from tests.training.takes import take_named
from training import features
from training.data.beat import read_beat_bvh
from training.data.folders import read_takes
from training.data.take import Kind, Take
from training.spaces.beat import UPPER_BODY_JOINTS
from training.speech_features.hubert import Hubert, stand_in
from training.speech_features.speech_frames import extract_all_frames
from training.speech_features.word_vectors import StandIn

ARM = UPPER_BODY_JOINTS.index("RightArm")

WIDTHS = {
    "beat": {"gesture": 141, "expression": 51, "mel": 128, "hubert": 1024, "semantic": 1},
    "show": {"gesture": 129, "expression": 103, "mel": 128, "hubert": 1024},
}

# Features are kept for as long as their version is the same. After an intended change, raise the
# version in the module and write its new numbers here.
GOLDEN = {
    ("beat", "1"): {
        "gesture": -0.04054,
        "expression": 0.06909,
        "mel": -0.0282,
        "hubert": 0.55207,
        "semantic": 0.0,
    },
    ("show", "1"): {"gesture": 0.01257, "expression": 0.0, "mel": 5e-05, "hubert": 0.6102},
}


@pytest.fixture
def take(tmp_path: Path) -> Take:
    """A take of BEAT that lasts two seconds, the arm down during the second one."""
    write_beat_take(tmp_path, seconds=2, moments=(1,))
    (take,) = read_takes(tmp_path).takes
    return take


@pytest.fixture(scope="module")
def hubert() -> Hubert:
    return stand_in()


def test_changed_features_require_a_new_version(take: Take, tmp_path: Path, hubert: Hubert) -> None:
    write_smplx(tmp_path / "show" / "a.npz", 2, moments=(1,))
    write_clicks(tmp_path / "show" / "a.wav", 2)
    (show,) = read_takes(tmp_path / "show").takes
    for dataset, one in (("beat", take), ("show", show)):
        extractors = {feature.name: feature for feature in training_features(dataset, hubert, 15)}
        computed = {name: feature.compute(one) for name, feature in extractors.items()}
        assert {name: values.shape for name, values in computed.items()} == {
            name: (30, width) for name, width in WIDTHS[dataset].items()
        }
        assert {values.dtype for values in computed.values()} == {np.dtype(np.float32)}
        result = {name: fingerprint(values)[0] for name, values in computed.items()}
        assert result == pytest.approx(GOLDEN[dataset, features.VERSION], abs=1e-4)
    other = features.hubert_features(15, replace(hubert, identity="another"))
    assert other.version != extractors["hubert"].version


def test_interpolated_frames_lie_on_the_shortest_rotation(take: Take) -> None:
    # Frame 95 of 95.2 a second, of which one in four is recorded, lies 0.8 of the way down.
    values = features.beat_gesture(119.9).compute(take).reshape(-1, 47, 3)[:, ARM]
    angles = np.degrees(np.linalg.norm(values, axis=1))
    inside = (angles > 1e-3) & (angles < DOWN - 1e-3)
    times = np.arange(len(angles)) / 119.9
    assert inside.sum() == 1
    assert 1 - 1 / 120 < times[inside][0] < 1
    share = times[inside][0] * 120 - 119
    assert angles[inside][0] == pytest.approx(share * DOWN, rel=1e-3)


def test_a_take_without_a_face_is_refused_with_the_missing_file(take: Take) -> None:
    with pytest.raises(InputError, match=r"no facial weights.*2_scott_0_9_9\.json"):
        features.beat_expression(15).compute(replace(take, face=None))
    with pytest.raises(InputError, match=r"no facial weights.*--ablation without_face"):
        computed("beat", replace(take, face=None), faces=True)


@pytest.mark.parametrize(
    ("seconds", "rate", "promised", "sound", "frame_rate"),
    [(2, 15, 240, 2.1, 15), (2, 120, 241, 2, 120), (3, 120, 600, 5, None)],
    ids=["thinned out", "a row fewer than declared", "truncated"],
)
def test_motion_is_read_at_the_rate_that_fits_the_sound_or_refused(
    tmp_path: Path, seconds: float, rate: int, promised: int, sound: float, frame_rate: float | None
) -> None:
    write_beat_motion(tmp_path / "2_scott_0_9_9.bvh", seconds, (1,), rate, promised=promised)
    write_clicks(tmp_path / "2_scott_0_9_9.wav", sound)
    (take,) = read_takes(tmp_path).takes
    if frame_rate is None:
        with pytest.raises(InputError, match=r"360 rows.*the sound lasts 5\.00 s"):
            read_beat_bvh(take)
    else:
        assert read_beat_bvh(take).frame_rate == frame_rate
        assert len(features.beat_gesture(15).compute(take)) == 30


def test_only_annotated_gestures_have_a_score(take: Take, tmp_path: Path) -> None:
    path = tmp_path / "scores.txt"
    path.write_text("beat\t0.5\t1.0\t0.5\t0.8\tyes\n")
    scored = features.semantic_scores(15).compute(replace(take, semantic=path))
    np.testing.assert_allclose(scored[:, 0], [0] * 8 + [0.8] * 7 + [0] * 15, atol=1e-6)
    assert not features.semantic_scores(15).compute(take).any()


def test_speech_features_are_the_same_as_in_generation(take: Take, hubert: Hubert) -> None:
    audio = read_audio(take.speech)
    heard = extract_all_frames(audio, 15, hubert)
    np.testing.assert_array_equal(features.mel(15).compute(take), heard.mel.numpy())
    result = features.hubert_features(15, hubert).compute(take)
    np.testing.assert_array_equal(result, heard.hubert.numpy())


def ted_take(folder: Path, **files: Path) -> Take:
    write_wav(folder / "a.wav", noise(2))
    directions = np.tile(standing()[:27].reshape(9, 3) * AXES, (30, 1, 1))
    np.savez(folder / "a.npz", directions=directions)
    return take_named("a", folder, motion=folder / "a.npz", **files)


def computed(kind: Kind, one: Take, *, faces: bool) -> dict[str, np.ndarray]:
    extractors = features.bone_features(kind, FACE, StandIn(), 15.0, faces=faces)
    return {feature.name: feature.compute(one) for feature in extractors}


def test_ted_gesture_is_rotated_to_our_axes_and_has_a_still_face(tmp_path: Path) -> None:
    (tmp_path / "a.lab").write_text("hello there")
    result = computed("ted", ted_take(tmp_path, transcript=tmp_path / "a.lab"), faces=False)
    assert {name: one.shape for name, one in result.items()} == {
        "motion": (30, 27 + 3 * FACE.count),
        "sound": (30, 84),
        "spectrum": (30, 128),
        "words": (30, 300),
    }
    np.testing.assert_allclose(result["motion"][7, :27], standing()[:27], atol=1e-5)
    assert not result["motion"][:, 27:].any()
    assert len(np.unique(result["words"], axis=0)) == 2
