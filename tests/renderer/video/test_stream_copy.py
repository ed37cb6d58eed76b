from __future__ import annotations

from fractions import Fraction
from itertools import product
from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio
from motion.errors import InputError
from renderer.video.encoder import SOUND_RATE
from renderer.video.stream_copy import copy_video, end_of
from tests.encoded import Told, write_video

LASTS = Fraction(2071, 1000)
SOURCES = {
    "plain": Told(),
    "named": Told(name="groundtruth", language="jpn", rate=25, frames=50),
    "ending-late": Told(frames=62, sound=Audio(0.1 * np.ones(99_000, np.float32), SOUND_RATE)),
}


def copied(folder: Path, told: Told, *, sound: bool = True) -> Path:
    write_video(folder / "source.mp4", told)
    copy_video(folder / "source.mp4", folder / "copy.mp4", lasts=LASTS, sound=sound)
    return folder / "copy.mp4"


def pictures(video: Path) -> list[bytes]:
    with av.open(str(video)) as container:
        return [frame.to_ndarray().tobytes() for frame in container.decode(video=0)]


def sounds(video: Path) -> list[bytes]:
    with av.open(str(video)) as container:
        return [bytes(packet) for packet in container.demux(audio=0) if packet.pts is not None]


@pytest.mark.parametrize("told", SOURCES.values(), ids=list(SOURCES))
def test_a_copy_shows_and_sounds_as_the_original_does(tmp_path: Path, told: Told) -> None:
    copy = copied(tmp_path, told)

    assert pictures(copy) == pictures(tmp_path / "source.mp4")
    assert sounds(copy) == sounds(tmp_path / "source.mp4")


def test_nothing_is_told_beside_picture_and_sound(tmp_path: Path) -> None:
    told = Told(name="groundtruth", language="jpn")
    copy = copied(tmp_path, told).read_bytes()

    source = (tmp_path / "source.mp4").read_bytes()
    for secret in (b"groundtruth", b"x264"):
        assert secret in source
        assert secret not in copy
    with av.open(str(tmp_path / "copy.mp4")) as container:
        assert "title" not in container.metadata
        assert {stream.metadata["language"] for stream in container.streams} == {"und"}


def test_copies_of_unlike_originals_last_equally_long(tmp_path: Path) -> None:
    lengths = set()
    for number, (told, sound) in enumerate(product(SOURCES.values(), (True, False))):
        folder = tmp_path / str(number)
        folder.mkdir()
        with av.open(str(copied(folder, told, sound=sound))) as container:
            picture = container.streams.video[0]
            assert picture.duration is not None
            assert picture.time_base is not None
            lengths.add((container.duration, picture.duration * picture.time_base))

    assert lengths == {(2_071_000, LASTS)}


def test_a_copy_without_sound_has_none_at_all(tmp_path: Path) -> None:
    with av.open(str(copied(tmp_path, Told(), sound=False))) as container:
        assert not container.streams.audio


def test_a_copy_plays_while_it_loads(tmp_path: Path) -> None:
    content = copied(tmp_path, Told()).read_bytes()

    assert 0 < content.index(b"moov") < content.index(b"mdat")


def test_the_end_is_that_of_picture_or_sound_whichever_is_later(tmp_path: Path) -> None:
    write_video(tmp_path / "late.mp4", SOURCES["ending-late"])
    write_video(tmp_path / "named.mp4", SOURCES["named"])

    assert float(end_of(tmp_path / "late.mp4")) == pytest.approx(62 / 30)
    assert float(end_of(tmp_path / "named.mp4")) == pytest.approx(2.0)


@pytest.mark.parametrize("content", [b"", b"no video"])
def test_what_is_no_video_is_named_and_nothing_is_written(tmp_path: Path, content: bytes) -> None:
    broken = tmp_path / "broken.mp4"
    broken.write_bytes(content)

    for attempt in (
        lambda: end_of(broken),
        lambda: copy_video(broken, tmp_path / "copy.mp4", lasts=LASTS, sound=True),
    ):
        with pytest.raises(InputError, match=r"broken.mp4: this is not a video"):
            attempt()
    assert list(tmp_path.iterdir()) == [broken]
