from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from studyapp.results.report_strips import frames_at
from tests.renderer.figures.small_videos import write_block_video
from tests.tiny_study import write_pair_video


def left_edge(picture: np.ndarray) -> int:
    """Return where the dark block begins."""
    return int(np.flatnonzero(picture[60, :, 0] < 120)[0])


def test_frames_are_those_of_their_moments(tmp_path: Path) -> None:
    video = write_block_video(tmp_path / "v.mkv", range(60))
    pictures = [np.asarray(one) for one in frames_at(video, (0.0, 0.5, 1.5), 128)]
    assert [left_edge(one) for one in pictures] == pytest.approx([0, 15, 45], abs=1)


def test_a_moment_past_the_end_gives_the_last_frame(tmp_path: Path) -> None:
    video = write_block_video(tmp_path / "v.mkv", range(30))
    early, late = frames_at(video, (0.1, 99.0), 128)
    assert left_edge(np.asarray(late)) == pytest.approx(29, abs=1)
    assert left_edge(np.asarray(early)) == pytest.approx(3, abs=1)


def test_the_longer_side_is_as_long_as_asked_for(tmp_path: Path) -> None:
    write_pair_video(tmp_path / "wide.mp4", shade=60, seconds=0.5)
    (picture,) = frames_at(tmp_path / "wide.mp4", (0.2,), 100)
    assert picture.size == (100, 50)


def test_a_file_that_is_no_video_is_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "v.mp4").write_bytes(b"no video")
    with pytest.raises(InputError, match=r"v\.mp4: the video cannot be read"):
        frames_at(tmp_path / "v.mp4", (0.0,), 100)
