"""What MP4 files hold: no bit rates, equal sizes, and copies of their picture."""

import tempfile
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.audio import Audio, write_wav
from motion.errors import InputError
from renderer.encoder import (
    SOUND_RATE,
    VideoWriter,
    clear_bit_rates,
    pad_to_equal_size,
    video_frame,
)
from renderer.loudness import read_excerpt
from renderer.stream_copy import copy_video, end_of, write_dubbed
from renderer.video_jobs import DubJob
from tests.support.encoded import VideoRecipe, pictures_of, write_video
from tests.support.sounds import noise, tone

NOISE = noise(1, SOUND_RATE)


def bit_rate(video: Path) -> bytes:
    """Return the bit rate of a video's sound as it is in the file."""
    with av.open(str(video)) as container:
        stream: Any = container.streams.audio[0]
        return bytes(stream.codec_context.bit_rate.to_bytes(4, "big"))


def test_only_the_bit_rates_of_the_sound_are_cleared(tmp_path: Path) -> None:
    video = tmp_path / "video.mp4"
    write_video(video, VideoRecipe(frames=30, sound=NOISE))
    sound, rate = packets(video, "audio"), bit_rate(video)
    before = video.read_bytes()

    clear_bit_rates(video)

    assert packets(video, "audio") == sound
    assert video.read_bytes().count(rate) == before.count(rate) - 2
    after = np.frombuffer(video.read_bytes(), np.uint8)
    changed = np.flatnonzero(np.frombuffer(before, np.uint8) != after)
    assert 0 < len(changed) <= 8
    assert changed[-1] - changed[0] < 8
    assert not after[changed].any()


def test_bit_rates_of_sound_with_a_long_setup_are_cleared(tmp_path: Path) -> None:
    video, long = tmp_path / "video.mp4", tmp_path / "long.mp4"
    write_video(video, VideoRecipe(sound=NOISE))
    with av.open(str(video)) as source, av.open(str(long), "w") as target:
        stream: Any = target.add_stream_from_template(source.streams.audio[0])
        stream.codec_context.extradata += bytes(200)
        for packet in source.demux(audio=0):
            if packet.pts is not None:
                packet.stream = stream
                target.mux(packet)
    assert any(bit_rate(long))

    clear_bit_rates(long)

    assert long.read_bytes().count(b"\x15" + bytes(11) + b"\x05") == 1


def boxes(data: bytes) -> list[bytes]:
    kinds, at = [], 0
    while at < len(data):
        size = int.from_bytes(data[at : at + 4], "big")
        assert size >= 8
        kinds.append(data[at + 4 : at + 8])
        at += size
    assert at == len(data)
    return kinds


@given(st.lists(st.integers(8, 40), max_size=6))
def test_padded_files_have_equal_size_and_valid_boxes(sizes: list[int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        videos = [Path(folder) / f"{k}.mp4" for k in range(len(sizes))]
        for video, size in zip(videos, sizes, strict=True):
            video.write_bytes(size.to_bytes(4, "big") + b"mdat" + b"x" * (size - 8))
        pad_to_equal_size(videos)
        contents = [video.read_bytes() for video in videos]
        assert len({len(content) for content in contents}) <= 1
        assert all(boxes(content)[0] == b"mdat" for content in contents)
        assert all(set(boxes(content)[1:]) <= {b"free"} for content in contents)


LASTS = Fraction(2071, 1000)
SOURCES = {
    "plain": VideoRecipe(),
    "named": VideoRecipe(name="groundtruth", language="jpn", rate=25, frames=50),
    "ending-late": VideoRecipe(
        frames=62, sound=Audio(0.1 * np.ones(99_000, np.float32), SOUND_RATE)
    ),
}

SECONDS = 2.03
RATE = 30


def copied(folder: Path, recipe: VideoRecipe, *, sound: bool = True) -> Path:
    write_video(folder / "source.mp4", recipe)
    copy_video(folder / "source.mp4", folder / "copy.mp4", lasts=LASTS, sound=sound)
    return folder / "copy.mp4"


def packets(video: Path, kind: str) -> list[bytes]:
    with av.open(str(video)) as container:
        (stream,) = [stream for stream in container.streams if stream.type == kind]
        return [bytes(packet) for packet in container.demux(stream) if packet.pts is not None]


@pytest.mark.parametrize(
    ("name", "end"), [("plain", 2), ("named", 2), ("ending-late", Fraction(62, 30))]
)
def test_a_copy_looks_and_sounds_like_the_original(
    tmp_path: Path, name: str, end: Fraction
) -> None:
    copy = copied(tmp_path, SOURCES[name])

    assert float(end_of(tmp_path / "source.mp4")) == pytest.approx(float(end))
    np.testing.assert_array_equal(pictures_of(copy), pictures_of(tmp_path / "source.mp4"))
    assert packets(copy, "audio") == packets(tmp_path / "source.mp4", "audio")


def test_a_copy_holds_no_metadata_and_plays_while_it_loads(tmp_path: Path) -> None:
    copy = copied(tmp_path, SOURCES["named"]).read_bytes()

    assert 0 < copy.index(b"moov") < copy.index(b"mdat")
    source = (tmp_path / "source.mp4").read_bytes()
    for secret in (b"groundtruth", b"x264"):
        assert secret in source
        assert secret not in copy
    with av.open(str(tmp_path / "copy.mp4")) as container:
        assert "title" not in container.metadata
        assert {stream.metadata["language"] for stream in container.streams} == {"und"}


def test_copies_of_different_originals_have_equal_length(tmp_path: Path) -> None:
    lengths = set()
    for number, (recipe, sound) in enumerate(product(SOURCES.values(), (True, False))):
        folder = tmp_path / str(number)
        folder.mkdir()
        with av.open(str(copied(folder, recipe, sound=sound))) as container:
            assert bool(container.streams.audio) == sound
            picture = container.streams.video[0]
            assert picture.duration is not None
            assert picture.time_base is not None
            lengths.add((container.duration, picture.duration * picture.time_base))

    assert lengths == {(2_071_000, LASTS)}


@pytest.mark.parametrize("content", [b"", b"no video"])
def test_an_unreadable_video_leaves_no_copy(tmp_path: Path, content: bytes) -> None:
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(content)

    for attempt in (
        lambda: end_of(broken),
        lambda: copy_video(broken, tmp_path / "copy.mp4", lasts=LASTS, sound=True),
    ):
        with pytest.raises(InputError, match=r"broken.mp4: the video cannot be played"):
            attempt()
    assert list(tmp_path.iterdir()) == [broken]


def rendered(folder: Path, seconds: float) -> Path:
    """Return a rendered clip with its speech, which is in the same folder."""
    write_wav(folder / "own.wav", tone(seconds, 200, SOUND_RATE))
    sound = read_excerpt(folder / "own.wav", 0.0, seconds)
    with VideoWriter(folder / "clip.mp4", 64, 64, RATE, sound) as writer:
        for shade in range(round(seconds * RATE)):
            writer.write(video_frame(np.full((64, 64, 3), 60 + shade % 99, np.uint8)))
    return folder / "clip.mp4"


@pytest.fixture
def clip(tmp_path: Path) -> Path:
    return rendered(tmp_path, SECONDS)


def dubbed(clip: Path, speech: str, seconds: float = SECONDS, end: float = SECONDS) -> Path:
    video = clip.with_name("dubbed.mp4")
    write_dubbed(
        DubJob(
            name="dubbed", picture=clip, speech=clip.with_name(speech), start=0.0, end=end,
            seconds=seconds, video=video,
        )
    )  # fmt: skip
    return video


# Above 10 seconds a muxer no longer waits for the other stream's packets.
@pytest.mark.parametrize("seconds", [SECONDS, 12.0])
def test_with_its_own_speech_the_file_is_identical(tmp_path: Path, seconds: float) -> None:
    clip = rendered(tmp_path, seconds)
    assert dubbed(clip, "own.wav", seconds, seconds).read_bytes() == clip.read_bytes()


@pytest.mark.parametrize("seconds", [1.5, 2.03, 2.5])
def test_another_speech_changes_neither_the_picture_nor_the_length(
    clip: Path, seconds: float
) -> None:
    write_wav(clip.with_name("other.wav"), tone(seconds, 400, SOUND_RATE))
    video = dubbed(clip, "other.wav", end=min(SECONDS, seconds))
    assert packets(video, "video") == packets(clip, "video")
    assert packets(video, "audio") != packets(clip, "audio")
    lasting = []
    for each in (clip, video):
        with av.open(str(each)) as container:
            lasting.append((container.duration, [stream.duration for stream in container.streams]))

    assert lasting[0] == lasting[1]


def test_an_error_names_a_damaged_clip(clip: Path) -> None:
    clip.write_bytes(b"no video")

    with pytest.raises(InputError, match=r"clip.mp4: the rendered clip cannot be read"):
        dubbed(clip, "own.wav")
    assert not clip.with_name("dubbed.mp4").exists()
