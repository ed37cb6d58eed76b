from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from renderer.video.mp4_padding import pad_to_equal_size


def boxes(data: bytes) -> list[bytes]:
    kinds, at = [], 0
    while at < len(data):
        size = int.from_bytes(data[at : at + 4], "big")
        assert size >= 8
        kinds.append(data[at + 4 : at + 8])
        at += size
    assert at == len(data)
    return kinds


@given(st.lists(st.integers(8, 200), min_size=1, max_size=6))
def test_files_end_up_equally_large_and_still_made_of_whole_boxes(sizes: list[int]) -> None:
    with tempfile.TemporaryDirectory() as folder:
        videos = [Path(folder) / f"{k}.mp4" for k in range(len(sizes))]
        for video, size in zip(videos, sizes, strict=True):
            video.write_bytes(size.to_bytes(4, "big") + b"mdat" + b"x" * (size - 8))
        pad_to_equal_size(videos)
        contents = [video.read_bytes() for video in videos]
        assert len({len(content) for content in contents}) == 1
        assert all(boxes(content)[0] == b"mdat" for content in contents)
        assert all(set(boxes(content)[1:]) <= {b"free"} for content in contents)


def test_padding_twice_changes_nothing(tmp_path: Path) -> None:
    videos = [tmp_path / "a.mp4", tmp_path / "b.mp4"]
    for video, size in zip(videos, (30, 100), strict=True):
        video.write_bytes(size.to_bytes(4, "big") + b"mdat" + b"x" * (size - 8))
    pad_to_equal_size(videos)
    before = [video.stat().st_mtime_ns for video in videos]
    pad_to_equal_size(videos)
    assert [video.stat().st_mtime_ns for video in videos] == before


def test_no_videos_need_no_padding() -> None:
    pad_to_equal_size([])


@pytest.mark.parametrize("difference", range(1, 8))
def test_a_difference_too_small_for_a_box_is_still_hidden(tmp_path: Path, difference: int) -> None:
    a, b = tmp_path / "a.mp4", tmp_path / "b.mp4"
    for video, size in ((a, 50), (b, 50 + difference)):
        video.write_bytes(size.to_bytes(4, "big") + b"mdat" + b"x" * (size - 8))
    pad_to_equal_size([a, b])
    assert a.stat().st_size == b.stat().st_size
