from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.metrics.conditions import study_metrics
from motion.audio import Audio, write_wav
from motion.errors import InputError
from motion.formats import write_clip


@pytest.fixture
def clicks(tmp_path):
    """Return a recording with a click at each half second."""
    samples = np.zeros(16000 * 4, np.float32)
    for start in range(4000, len(samples), 8000):
        samples[start : start + 320] = 0.8 * np.sin(np.arange(320) * 0.6) * np.hanning(320)
    write_wav(tmp_path / "clicks.wav", Audio(samples, 16000))
    return tmp_path / "clicks.wav"


@pytest.fixture
def study(tmp_path, clicks, waving):
    """Return motion files of a waving and of a static condition, and their speech."""
    clips = {"waving": {}, "static": {}}
    for segment, amplitude in (("a", 0.4), ("b", 0.8)):
        for condition, size in (("waving", amplitude), ("static", 0.0)):
            path = tmp_path / condition / f"{segment}.npz"
            write_clip(path, waving(amplitude=size))
            clips[condition][segment] = path
    return clips, dict.fromkeys("ab", (clicks, 0.0, 4.0))


def of(metrics, condition, name):
    return next(s for s in metrics.conditions if (s.condition, s.name) == (condition, name))


def test_every_condition_gets_every_metric(study):
    metrics = study_metrics(*study)
    names = {s.name for s in metrics.conditions}
    assert len(metrics.conditions) == 2 * len(names)
    assert {"jerk (hands)", "mean distance between clips"} <= names
    assert any(name.startswith("beat alignment above chance") for name in names)
    assert metrics.frame_rate == 30.0
    assert all(s.settings["frame rate"] == "30 fps" for s in metrics.conditions)


def test_a_condition_is_the_mean_over_its_clips(study):
    metrics = study_metrics(*study)
    values = [
        s.result.value
        for s in metrics.clips
        if s.condition == "waving" and s.result.name == "jerk (hands)"
    ]
    found = of(metrics, "waving", "jerk (hands)")
    assert len(values) == 2
    assert found.value == pytest.approx(np.mean(values))
    assert found.spread == pytest.approx(np.std(values, ddof=1))
    assert (found.scored, found.clips) == (2, 2)


def test_a_motionless_condition_has_no_beat_alignment_and_the_reason_counts_clips(study):
    found = of(study_metrics(*study), "static", "beat alignment above chance (amuse)")
    assert math.isnan(found.value)
    assert found.scored == 0
    assert found.reason == "the motion has no beat (2 of 2 clips)"


def test_without_speech_there_is_no_beat_alignment(study):
    metrics = study_metrics(study[0], {})
    assert not any("beat" in s.name for s in metrics.conditions)
    assert of(metrics, "waving", "jerk (hands)").scored == 2


def test_no_clips_are_no_metrics():
    assert study_metrics({}, {}).conditions == ()


def test_a_missing_motion_is_named(study, tmp_path):
    clips, speech = study
    clips["static"]["c"] = tmp_path / "nowhere.npz"
    with pytest.raises(InputError, match=r"nowhere\.npz"):
        study_metrics(clips, speech)
