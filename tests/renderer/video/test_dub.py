from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio, read_audio, write_wav
from motion.errors import InputError
from renderer.video.dub import write_dubbed
from renderer.video.encoder import SOUND_RATE, VideoWriter, video_frame
from renderer.video.loudness import at_common_loudness

SECONDS = 2.03
RATE = 30


def tone(seconds: float, pitch: float) -> Audio:
    moments = np.arange(round(seconds * SOUND_RATE)) / SOUND_RATE
    return Audio((0.2 * np.sin(2 * np.pi * pitch * moments)).astype(np.float32), SOUND_RATE)


def rendered(folder: Path, seconds: float) -> Path:
    """Return a rendered clip with its own speech, which lies beside it."""
    write_wav(folder / "own.wav", tone(seconds, 200))
    speech = read_audio(folder / "own.wav", sample_rate=SOUND_RATE)
    with VideoWriter(folder / "clip.mp4", 64, 64, RATE, at_common_loudness(speech)) as writer:
        for shade in range(round(seconds * RATE)):
            writer.write(video_frame(np.full((64, 64, 3), 60 + shade % 99, np.uint8)))
    return folder / "clip.mp4"


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return rendered(tmp_path, SECONDS)


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


# Above 10 seconds a muxer no longer waits for the other stream's packets.
@pytest.mark.parametrize("seconds", [SECONDS, 12.0])
def test_with_its_own_speech_the_file_is_the_same_to_the_byte(
    tmp_path: Path, seconds: float
) -> None:
    clip = rendered(tmp_path, seconds)
    write_dubbed(
        picture=clip,
        speech=clip.with_name("own.wav"),
        start=0.0,
        end=seconds,
        seconds=seconds,
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
