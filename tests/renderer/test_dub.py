from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio, read_audio, write_wav
from motion.errors import InputError
from renderer.dub import write_dubbed
from renderer.encoder import SOUND_RATE, VideoWriter, video_frame
from renderer.loudness import at_common_loudness

SECONDS = 2.03
RATE = 30


def tone(seconds: float, pitch: float) -> Audio:
    moments = np.arange(round(seconds * SOUND_RATE)) / SOUND_RATE
    return Audio((0.2 * np.sin(2 * np.pi * pitch * moments)).astype(np.float32), SOUND_RATE)


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    """Return a rendered clip with its own speech, which lies beside it."""
    write_wav(tmp_path / "own.wav", tone(SECONDS, 200))
    speech = read_audio(tmp_path / "own.wav", sample_rate=SOUND_RATE)
    with VideoWriter(tmp_path / "clip.mp4", 64, 64, RATE, at_common_loudness(speech)) as writer:
        for shade in range(round(SECONDS * RATE)):
            writer.write(video_frame(np.full((64, 64, 3), 60 + shade, np.uint8)))
    return tmp_path / "clip.mp4"


def packets(video: Path, kind: str) -> list[bytes]:
    with av.open(str(video)) as container:
        (stream,) = [stream for stream in container.streams if stream.type == kind]
        return [bytes(packet) for packet in container.demux(stream) if packet.pts is not None]


def dubbed(clip: Path, speech: Audio) -> Path:
    write_wav(clip.with_name("other.wav"), speech)
    video = clip.with_name("dubbed.mp4")
    write_dubbed(
        picture=clip,
        speech=clip.with_name("other.wav"),
        start=0.0,
        end=min(SECONDS, speech.duration),
        seconds=SECONDS,
        video=video,
    )
    return video


def test_the_picture_is_the_same_and_the_sound_another_one(clip: Path) -> None:
    video = dubbed(clip, tone(3.0, 400))

    assert packets(video, "video") == packets(clip, "video")
    assert packets(video, "audio") != packets(clip, "audio")


def test_with_its_own_speech_the_file_is_the_same_to_the_byte(clip: Path) -> None:
    write_dubbed(
        picture=clip,
        speech=clip.with_name("own.wav"),
        start=0.0,
        end=SECONDS,
        seconds=SECONDS,
        video=clip.with_name("again.mp4"),
    )

    assert clip.with_name("again.mp4").read_bytes() == clip.read_bytes()


@pytest.mark.parametrize("seconds", [1.5, 2.03, 2.5])
def test_a_shorter_speech_makes_no_shorter_video(clip: Path, seconds: float) -> None:
    lasting = []
    for video in (clip, dubbed(clip, tone(seconds, 400))):
        with av.open(str(video)) as container:
            lasting.append((container.duration, [stream.duration for stream in container.streams]))

    assert lasting[0] == lasting[1]


def test_a_clip_that_is_damaged_is_named(clip: Path) -> None:
    clip.write_bytes(b"no video")

    with pytest.raises(InputError, match=r"clip.mp4: the rendered clip cannot be read"):
        dubbed(clip, tone(2.0, 400))
    assert not clip.with_name("dubbed.mp4").exists()
