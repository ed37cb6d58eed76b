from __future__ import annotations

from pathlib import Path

import av
import pytest

from motion.audio import Audio, write_wav
from studyapp.stages.media_probe import flaw_of


@pytest.fixture
def video(tiny_study_template: Path) -> Path:
    return next((tiny_study_template / "videos").rglob("*.mp4"))


def test_a_whole_video_has_no_flaw(video: Path) -> None:
    assert flaw_of(video, 2.0) is None


def test_a_video_of_another_length_is_told(video: Path) -> None:
    assert flaw_of(video, 5.0) == "lasts 2.00 s, its segment 5.00 s"


def test_sound_alone_is_no_video(tmp_path: Path) -> None:
    sound = tmp_path / "sound.wav"
    write_wav(sound, Audio(samples=[0.0] * 16_000, sample_rate=16_000))
    assert flaw_of(sound, 1.0) == "has no picture"


def test_a_video_without_sound_is_told(video: Path, tmp_path: Path) -> None:
    silent = tmp_path / "silent.mp4"
    with av.open(str(video)) as source, av.open(str(silent), "w") as target:
        stream = target.add_stream_from_template(source.streams.video[0])
        for packet in source.demux(video=0):
            if packet.dts is not None:
                packet.stream = stream
                target.mux(packet)
    assert flaw_of(silent, 2.0) == "has no sound"
