import math
import pickle
import shutil
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from analysis.evaluators import feature_networks
from analysis.measurement.measured_clips import Excerpt
from analysis.measurement.measuring import study_metrics
from analysis.measurement.presets import PRESETS, combined
from analysis.report.sections.metrics import PAPER_TABLES
from motion.audio import Audio, write_wav
from motion.formats import write_clip
from tests.analysis.measurement.reading import clip_scores, score_of
from tests.analysis.waving import waving

Clips = dict[str, dict[str, Path]]
Speech = dict[str, Excerpt]
Study = tuple[Clips, Speech]
RecordedStudy = tuple[Clips, Speech, dict[str, Path]]


@pytest.fixture
def clicks(tmp_path: Path) -> Path:
    """Return a recording with a click at each half second."""
    samples = np.zeros(16000 * 4, np.float32)
    for start in range(4000, len(samples), 8000):
        samples[start : start + 320] = 0.8 * np.sin(np.arange(320) * 0.6) * np.hanning(320)
    write_wav(tmp_path / "clicks.wav", Audio(samples, 16000))
    return tmp_path / "clicks.wav"


@pytest.fixture
def study(tmp_path: Path, clicks: Path) -> Study:
    """Return motion files of a waving and of a static condition, and their speech."""
    clips: Clips = {"waving": {}, "static": {}}
    for segment, amplitude in (("a", 0.4), ("b", 0.8)):
        for condition, size in (("waving", amplitude), ("static", 0.0)):
            path = tmp_path / condition / f"{segment}.npz"
            write_clip(path, waving(amplitude=size))
            clips[condition][segment] = path
    return clips, dict.fromkeys("ab", (clicks, 0.0, 4.0))


def test_every_condition_gets_every_metric_as_the_mean_over_its_clips(study: Study) -> None:
    metrics = study_metrics(*study, presets=PRESETS)
    names = {s.name for s in metrics.conditions if "autoencoder" not in s.name}
    assert {"jerk (hands)", "jerk (genea)", "foot sliding", "mean distance between clips"} <= names
    assert not names & ERRORS
    assert pickle.dumps(metrics.clips)  # as other processes send them
    assert metrics.frame_rate == 30.0
    jerk = score_of(metrics, "waving", "jerk (hands)")
    values = [*clip_scores(metrics, "waving", "jerk (hands)").values()]
    assert jerk.value == pytest.approx(np.mean(values))
    assert jerk.spread == pytest.approx(np.std(values, ddof=1))
    assert (jerk.scored, jerk.clips, jerk.settings["frame rate"]) == (2, 2, "30 fps")
    motionless = score_of(metrics, "static", "beat alignment above chance (amuse)")
    assert math.isnan(motionless.value)
    assert (motionless.scored, motionless.reason) == (0, "the motion has no beat (2 of 2 clips)")


@pytest.fixture
def recorded_study(tmp_path: Path, study: Study) -> RecordedStudy:
    """Return a study with recordings, which two conditions are and are a copy of."""
    clips, speech = study
    recorded = {}
    for number, segment in enumerate("ab"):
        recorded[segment] = tmp_path / "recorded" / f"{segment}.npz"
        write_clip(recorded[segment], waving(amplitude=0.5 + 0.1 * number, frequency=0.8))
    clips["recorded"] = dict(recorded)
    copies = shutil.copytree(tmp_path / "recorded", tmp_path / "copied")
    clips["copied"] = {segment: copies / f"{segment}.npz" for segment in recorded}
    return clips, speech, recorded


ERRORS = {
    "mean absolute error (MAJE, s2ue)",
    "mean acceleration error (MAcE-P, s2ue)",
    "velocity error (L1)",
    "velocity error (L2)",
}


def test_a_copy_of_the_recordings_scores_perfectly_and_other_motion_does_not(
    recorded_study: RecordedStudy,
) -> None:
    clips, _, recorded = recorded_study
    metrics = study_metrics(clips, {}, recorded=recorded, presets=PRESETS)
    for name in ERRORS:
        assert score_of(metrics, "copied", name).value == 0
        assert score_of(metrics, "waving", name).value > 0
        assert score_of(metrics, "waving", name).better == "lower"
    for preset in ("amuse", "beat", "diffsheg"):
        name = f"percent of correct motion ({preset})"
        assert score_of(metrics, "copied", name).value == 1
        assert score_of(metrics, "waving", name).value < 1
        assert "left_wrist" in score_of(metrics, "copied", name).settings["joints"]
    assert not {s.name for s in metrics.conditions if s.condition == "recorded"} & ERRORS
    assert score_of(metrics, "recorded", "foot sliding").value == 0
    assert all(s.settings["frame rate"] for s in metrics.conditions if not s.reason)


def test_files_that_cannot_be_used_are_named_and_the_rest_is_measured(
    study: Study, tmp_path: Path
) -> None:
    clips, speech = study
    bad = tmp_path / "waving" / "c.npz"
    bad.write_bytes(b"PK no archive")
    clips["waving"]["c"] = bad
    clips["static"]["c"] = tmp_path / "nowhere.npz"
    torn = tmp_path / "static" / "b.npz"
    torn.write_bytes(torn.read_bytes()[:-200])
    speech["a"] = (tmp_path / "silent.wav", 0.0, 4.0)
    damaged = tmp_path / "a.txt"
    damaged.write_text("no annotation", encoding="utf-8")
    metrics = study_metrics(
        clips,
        speech,
        recorded=clips["waving"],
        semantics={"a": damaged},
        presets=("report", "amuse"),
    )
    assert sorted(file.where for file in metrics.skipped) == sorted(
        [
            *(str(bad), str(torn), str(tmp_path / "nowhere.npz")),
            *(str(tmp_path / "silent.wav"), f"{damaged}, line 1"),
        ]
    )
    assert score_of(metrics, "waving", "jerk (hands)").scored == 2
    assert score_of(metrics, "static", "jerk (hands)").scored == 1
    assert score_of(metrics, "waving", "beat alignment (amuse)").clips == 1
    nothing = study_metrics({"x": {"a": bad}}, {})
    assert nothing.conditions == ()
    assert [file.where for file in nothing.skipped] == [str(bad)]


def test_cached_values_change_no_number(study: Study, tmp_path: Path) -> None:
    folder = tmp_path / "kept"
    alone = study_metrics(*study)
    first = study_metrics(*study, kept=folder)
    kept = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    # Both motionless clips are the same file, and both segments the same speech.
    assert sorted(path.name.partition("-")[0] for path in kept) == ["joints"] * 3 + ["onsets"]
    second = study_metrics(*study, kept=folder)
    assert {path: path.stat().st_mtime_ns for path in folder.iterdir()} == kept
    for other in (first, second):
        np.testing.assert_equal(
            [s.result.value for s in alone.clips], [s.result.value for s in other.clips]
        )


@pytest.mark.slow
def test_the_number_of_processes_does_not_change_the_scores(recorded_study: RecordedStudy) -> None:
    clips, _, recorded = recorded_study
    measure = partial(study_metrics, clips, {}, recorded=recorded, presets=PRESETS)
    progress = []
    alone = measure()
    together = measure(processes=2, on_progress=lambda *done: progress.append(done))
    assert progress == [(done, 4) for done in (1, 2, 3, 4)]
    assert [s.result.name for s in alone.clips] == [s.result.name for s in together.clips]
    np.testing.assert_equal(
        [s.result.value for s in alone.clips], [s.result.value for s in together.clips]
    )


def test_missing_inputs_of_metrics_are_reported(recorded_study: RecordedStudy) -> None:
    clips, speech, recorded = recorded_study
    speech.pop("a")
    recorded.pop("b")
    found = study_metrics(clips, speech, recorded=recorded, presets=("amuse",)).remarks
    assert found == (
        "no beat alignment without speech: 1 of 2 segments (a)",
        "no comparison without a recording: 1 of 2 segments (b)",
    )
    alone = study_metrics(clips, {}, presets=("genea",))
    assert not any("beat" in s.name for s in alone.conditions)
    assert alone.remarks == ("no recordings are given, so nothing is compared with them",)


def test_clips_are_compared_at_the_lowest_stated_or_actual_rate_up_to_thirty(
    study: Study, tmp_path: Path
) -> None:
    folder = tmp_path / "kept"
    fast = study_metrics(*study, file_rate=30.0, kept=folder)
    slow = study_metrics(*study, file_rate=15.0, kept=folder)
    assert (fast.frame_rate, slow.frame_rate) == (30, 15)
    assert study_metrics(*study, file_rate=60.0).frame_rate == 30
    name = "jerk (hands, unfiltered)"
    assert score_of(fast, "waving", name).value == pytest.approx(
        8 * score_of(slow, "waving", name).value
    )
    clips, speech = study
    clips["slow"] = {"a": tmp_path / "slow.npz"}
    write_clip(clips["slow"]["a"], waving(frame_rate=20.0))
    metrics = study_metrics(clips, speech)
    assert score_of(metrics, "waving", "jerk (hands)").settings["frame rate"] == "20 fps"


def test_semantic_scores_weight_the_recalled_frames(
    recorded_study: RecordedStudy, tmp_path: Path
) -> None:
    clips, _, recorded = recorded_study
    spans = {"a": "beat\t0\t4\t4\t0.3\t", "b": "none\t0\t4\t4\t0\t"}
    semantics = {segment: tmp_path / f"{segment}.txt" for segment in spans}
    for segment, span in spans.items():
        semantics[segment].write_text(span, encoding="utf-8")
    metrics = study_metrics(
        clips, {}, recorded=recorded, semantics=semantics, presets=("amuse", "beat")
    )
    for preset in ("amuse", "beat"):
        copied = score_of(metrics, "copied", f"semantic-relevant gesture recall ({preset})")
        assert copied.value == 1
        assert copied.reason == "no frame has a semantic score above 0 (1 of 2 clips)"
        other = score_of(metrics, "waving", f"semantic-relevant gesture recall ({preset})")
        correct = clip_scores(metrics, "waving", f"percent of correct motion ({preset})")
        assert other.value == pytest.approx(correct["a"])
    assert not any("recall" in s.name for s in metrics.conditions if s.condition == "recorded")


def test_metrics_shared_by_two_presets_are_measured_once() -> None:
    together = combined(["beat", "diffsheg", "beat"])
    assert together.beats == PRESETS["beat"].beats == PRESETS["diffsheg"].beats
    assert [settings.name for settings in together.correct] == ["beat", "diffsheg"]
    assert together.mean_pose_deviation
    assert together.pair_distance
    assert not together.foot_sliding


def test_the_documentation_lists_every_metric_with_its_presets(
    recorded_study: RecordedStudy,
) -> None:
    clips, speech, recorded = recorded_study
    lines = Path("docs/metrics.md").read_text("utf-8").splitlines()
    rows = [line.split("|")[1:5] for line in lines if line.count("|") == 6]
    for preset in PRESETS:
        metrics = study_metrics(
            {"waving": clips["waving"]}, speech, recorded=recorded, presets=[preset]
        )
        for name in {score.name.partition(" (")[0] for score in metrics.conditions}:
            presets = [row[3] for row in rows if name in row[0]]
            assert any(preset in each or "with it" in each for each in presets), (preset, name)


def test_a_papers_table_shows_each_score_of_its_preset_once() -> None:
    distances = set(feature_networks.DISTANCES.values())
    for preset, columns in PAPER_TABLES.items():
        assert preset in PRESETS
        metrics = {column.metric for column in columns}
        assert len(metrics) == len(columns)
        assert {name for name in metrics if name.startswith(("FGD", "FED", "FMD"))} <= distances
