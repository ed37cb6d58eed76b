from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from analysis.evaluators import feature_networks as names
from analysis.evaluators.feature_networks import networks
from analysis.measurement.measured_clips import LandmarkBody
from analysis.measurement.measuring import study_metrics
from analysis.metrics.scores import StudyMetrics
from motion.arrays import Floats32
from motion.clip import MotionClip, arkit_index
from motion.errors import InputError
from motion.formats import write_clip
from renderer.look import default_body
from tests.analysis.measurement.reading import score_of
from tests.analysis.waving import waving
from tests.motion.random_clips import clip_of

Clips = dict[str, dict[str, Path]]


class MeanPose:
    """Stands for a trained network: the mean and spread of a few joints' rotations."""

    labels = ()
    name = names.GESTURE
    rule = None

    def __init__(self, path: Path) -> None:
        self.sha256 = path.read_text()
        self.seen: list[MotionClip] = []

    def describe(self) -> Mapping[str, str]:
        return {"network sha256": self.sha256}

    def embed(self, clip: MotionClip) -> Floats32:
        self.seen.append(clip)
        if len(clip) < 60:
            raise InputError("the clip is shorter than a window")
        if not clip.poses.any():
            return np.full((2, 2), np.nan, np.float32)
        halves = np.array_split(clip.poses[:, 16:20].reshape(len(clip), -1), 2)
        return np.array([[h.mean(0)[2], h.std(0)[2]] for h in halves], np.float32)


NetworkFile = tuple[Path, dict[Path, MeanPose]]


@pytest.fixture
def network_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[NetworkFile]:
    """Return the file of a stand-in network, and its inputs."""
    opened: dict[Path, MeanPose] = {}

    def opening(path: Path) -> MeanPose:
        return opened.setdefault(path, MeanPose(path))

    monkeypatch.setattr(names, "open_network", opening)
    names._opened.cache_clear()
    path = tmp_path / "network"
    path.write_text("c0ffee" * 11)
    yield path, opened
    names._opened.cache_clear()


@pytest.fixture
def study(tmp_path: Path) -> Clips:
    clips: Clips = {"truth": {}, "ours": {}}
    for condition, size in (("truth", 0.5), ("ours", 0.8)):
        for number in range(6):
            path = tmp_path / condition / f"{number}.npz"
            write_clip(path, waving(amplitude=size + number / 20, seconds=2.5))
            clips[condition][f"s{number}"] = path
    return clips


def test_each_clip_is_embedded_once_and_its_features_are_cached(
    study: Clips, network_file: NetworkFile, tmp_path: Path
) -> None:
    path, opened = network_file
    kept = tmp_path / "kept"
    first, second = (
        study_metrics(
            study, {}, recorded=study["truth"], evaluators=[path], presets=["genea"], kept=kept
        )
        for _ in range(2)
    )
    assert len(opened[path].seen) == 12
    assert score_of(first, "ours", names.FGD).value > 0
    assert [s.value for s in first.conditions] == pytest.approx(
        [s.value for s in second.conditions], nan_ok=True
    )
    assert score_of(first, "ours", names.FGD).settings["network sha256"] == "c0ffee" * 11


def test_the_studys_channels_are_frozen_for_the_network(
    study: Clips, network_file: NetworkFile
) -> None:
    path, opened = network_file
    study_metrics(study, {}, frozen=("hands", "root"), evaluators=[path])
    assert all(np.ptp(clip.trans) == 0 for clip in opened[path].seen)


def test_clips_without_usable_features_are_left_out_with_their_reasons(
    study: Clips, network_file: NetworkFile
) -> None:
    path, _ = network_file
    write_clip(study["ours"]["s0"], waving(seconds=1.0))
    write_clip(study["ours"]["s1"], waving(amplitude=0.0))
    found = study_metrics(study, {}, recorded=study["truth"], evaluators=[path])
    score = score_of(found, "ours", names.FGD)
    assert (score.scored, score.clips) == (4, 6)
    assert "shorter than a window (1 of 6 clips)" in score.remark
    assert "the network's features are not finite (1 of 6 clips)" in score.remark
    of_one = {"ours": {"s0": study["ours"]["s0"]}}
    none = study_metrics(of_one, {}, recorded=study["truth"], evaluators=[path])
    assert "shorter than a window (1 of 1 clips)" in score_of(none, "ours", names.FGD).reason


def test_two_networks_of_one_kind_differ_by_their_hash(
    network_file: NetworkFile, tmp_path: Path
) -> None:
    path, _ = network_file
    other, same = tmp_path / "other", tmp_path / "same"
    other.write_text("beef" * 16)
    same.write_text(path.read_text())
    found = networks([path, other, same])
    assert [n.name for n in found] == [
        "gesture autoencoder, c0ffeec0",
        "gesture autoencoder, beefbeef",
    ]
    assert names.distance_of(found[1].name) == "FGD (gesture autoencoder, beefbeef)"


def test_a_missing_network_is_listed_with_its_training_command(study: Clips) -> None:
    found = study_metrics(study, {}, recorded=study["truth"], presets=["s2ue", "amuse"])
    for name, command in (
        (names.FLD, "face"),
        (names.FGD_OF_EMOTION, "emotion"),
        (names.VARIANCE_OF_EMOTION, "emotion"),
        (names.EMOTION_ACCURACY, "emotion"),
    ):
        reason = score_of(found, "ours", name).reason
        assert f"'motionjury train evaluator {command}' trains one" in reason
    of_recordings = {s.name for s in found.conditions if s.condition == "truth"}
    assert not of_recordings & {names.FLD, names.FGD_OF_EMOTION}
    assert names.EMOTION_ACCURACY in of_recordings


@pytest.fixture
def talking(tmp_path: Path) -> Clips:
    """Return recorded faces, and generated ones: a copy, and one that opens the mouth less."""
    clips: Clips = {"truth": {}, "copied": {}, "shy": {}}
    for number in range(2):
        opening = np.abs(np.sin(np.arange(60) / (5 + number)))
        for condition, share in (("truth", 1.0), ("copied", 1.0), ("shy", 0.5)):
            arkit = np.zeros((60, 52), np.float32)
            arkit[:, arkit_index("jawOpen")] = share * opening
            path = tmp_path / condition / f"{number}.npz"
            poses = np.random.default_rng(number).normal(0, 0.01, (60, 55, 3))
            write_clip(path, clip_of(poses, arkit=arkit))
            clips[condition][str(number)] = path
    return clips


LANDMARK_ERRORS = ("mean absolute error (MALE, s2ue)", "mean acceleration error (MAcE-LM, s2ue)")


def test_landmark_errors_are_zero_for_a_copy_and_millimetres_otherwise(talking: Clips) -> None:
    def measured(**settings: Any) -> StudyMetrics:
        face = {"face": LandmarkBody(path=default_body())} | settings
        return study_metrics(talking, {}, recorded=talking["truth"], presets=["s2ue"], **face)

    found = measured()
    for name in LANDMARK_ERRORS:
        assert score_of(found, "copied", name).value == 0
        assert score_of(found, "shy", name).value > 0.1
        for settings, reason in (
            ({"frozen": ("face",)}, "holds the face still"),
            ({"face": None}, "no body is given"),
        ):
            assert reason in score_of(measured(**settings), "shy", name).reason
    assert score_of(found, "shy", LANDMARK_ERRORS[0]).settings["frame rate"] == "15 fps"
    write_clip(talking["shy"]["0"], waving(seconds=2.0))
    faceless = score_of(measured(), "shy", LANDMARK_ERRORS[0])
    assert (faceless.scored, faceless.clips) == (1, 2)
    assert "has no face" in faceless.reason
    write_clip(talking["truth"]["1"], waving(seconds=2.0))
    without_recorded_face = score_of(measured(), "shy", LANDMARK_ERRORS[0])
    assert "the recording has no landmarks: " in without_recorded_face.reason


def test_faces_differ_between_clips_unless_frozen(talking: Clips) -> None:
    name = "mean distance between clips (expressions)"
    moving = score_of(study_metrics(talking, {}, presets=["diffsheg"]), "truth", name)
    assert moving.value > 0
    assert moving.settings["face"] == "ARKit weights"
    still = score_of(
        study_metrics(talking, {}, presets=["diffsheg"], frozen=("face",)), "truth", name
    )
    assert still.reason == "the study holds the face still"


def test_penetration_is_measured_with_a_body_and_cached(
    talking: Clips, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted: dict[str, Any] = {
        "penetrable": default_body("mannequin"),
        "presets": ["genea"],
        "kept": tmp_path / "kept",
    }
    found = study_metrics(talking, {}, **wanted)
    assert score_of(found, "shy", "self-penetration, depth").value == 0
    assert score_of(found, "shy", "self-penetration, depth").scored == 2
    monkeypatch.setattr("analysis.measurement.measured_clips.penetrable_body", lambda body: None)
    again = study_metrics(talking, {}, **wanted)
    assert score_of(again, "shy", "self-penetration, share of frames").value == 0
