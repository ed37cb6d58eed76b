from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import av
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from motion.audio import Audio
from renderer.encoder import SOUND_RATE, clear_bit_rates, pad_to_equal_size
from tests.support.encoded import Told, write_video

NOISE = Audio(np.random.default_rng(0).normal(0, 0.05, SOUND_RATE).astype(np.float32), SOUND_RATE)


def heard(video: Path) -> tuple[list[bytes], bytes]:
    """Return the encoded sound of a video, and its bit rate as in the file."""
    with av.open(str(video)) as container:
        stream: Any = container.streams.audio[0]
        rate = stream.codec_context.bit_rate.to_bytes(4, "big")
        return [bytes(p) for p in container.demux(stream) if p.pts is not None], rate


def test_only_the_bit_rates_of_the_sound_are_cleared(
    tmp_path: Path,
) -> None:
    video = tmp_path / "video.mp4"
    write_video(video, Told(frames=30, sound=NOISE))
    sound, rate = heard(video)
    before = video.read_bytes()

    clear_bit_rates(video)

    assert heard(video)[0] == sound
    assert video.read_bytes().count(rate) == before.count(rate) - 2
    after = np.frombuffer(video.read_bytes(), np.uint8)
    changed = np.flatnonzero(np.frombuffer(before, np.uint8) != after)
    assert 0 < len(changed) <= 8
    assert changed[-1] - changed[0] < 8
    assert not after[changed].any()


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
