from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, read_audio, write_wav
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.loudness import integrated_loudness
from studyapp.stimuli.media_probe import Flaw, flaw_of


@pytest.fixture
def video(tiny_study_template: Path) -> Path:
    return next((tiny_study_template / "videos").rglob("*.mp4"))


def test_sound_alone_is_no_video(tmp_path: Path) -> None:
    sound = tmp_path / "sound.wav"
    write_wav(sound, Audio(samples=np.zeros(16_000, np.float32), sample_rate=16_000))
    assert flaw_of(sound, 1.0) == Flaw("no picture", "has no picture")


def test_the_loudness_of_a_video_is_that_of_its_sound(tmp_path: Path) -> None:
    moments = np.arange(2 * SOUND_RATE) / SOUND_RATE
    sound = Audio((0.1 * np.sin(2 * np.pi * 997 * moments)).astype(np.float32), SOUND_RATE)
    with VideoWriter(tmp_path / "video.mp4", 64, 64, 30, sound):
        pass
    # A sine of 997 Hz at full scale has -3.01 LUFS (ITU-R BS.1770); this is 20 dB below.
    heard = read_audio(tmp_path / "video.mp4", sample_rate=None)
    assert integrated_loudness(heard) == pytest.approx(-23.01, abs=0.2)
