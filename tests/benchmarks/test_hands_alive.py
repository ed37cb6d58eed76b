"""Hands move as much, and rest as seldom, as recorded ones (BEAT: 13 to 24 °/s, 0 to 23 %)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from benchmarks.hands_alive import RESTS, generated, hands_alive, main
from motion.audio import read_audio
from motion.formats import read_motion
from motion.skeleton import joint_index
from tests.motion.random_clips import clip_of


def test_a_turning_finger_and_a_shifted_body_are_measured_in_degrees_and_metres() -> None:
    poses = np.zeros((31, 55, 3), np.float32)
    poses[:, joint_index("left_index2"), 2] = np.radians(60) * np.arange(31) / 30
    trans = np.outer(np.arange(31) / 30, [1.01 * RESTS, 0, 0])
    found = hands_alive(clip_of(poses, trans))
    assert found.fingers == pytest.approx(60 / 30, rel=1e-3)
    assert found.resting == 0.0
    assert hands_alive(clip_of(poses, trans / 2)).resting == 1.0


def test_neutral_hands_move_and_rest_like_recorded_ones(shared_data: Path) -> None:
    audio = read_audio(shared_data / "2_scott_0_103_103.wav").cut(0, 30)
    for seed in (1, 2):
        found = hands_alive(generated(audio, "neutral", seed=seed))
        assert 13 < found.fingers < 24
        assert found.resting < 0.23


def test_a_recording_is_as_alive_as_was_stated(shared_data: Path) -> None:
    found = hands_alive(read_motion(shared_data / "2_scott_0_1_1.bvh", frame_rate=15))
    assert found.fingers == pytest.approx(13.9, abs=0.1)
    assert found.resting == pytest.approx(0.01, abs=0.01)


def test_every_emotion_is_printed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("benchmarks.hands_alive._MADE_SECONDS", 3.0)
    main([])
    printed = capsys.readouterr().out
    assert printed.startswith("neutral: fingers ")
    assert len(printed.splitlines()) == 8
