import base64
import io
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from analysis.report.content import Still
from studyapp.results.report_subject import (
    NO_VIDEOS,
    STILL_COUNT,
    STILL_PIXELS,
    frames_at,
    study_stills,
)
from studyapp.study.folder import StudyFolder
from tests.renderer.figures.small_videos import write_block_video
from tests.studyapp.conftest import OwnStudy
from tests.support.studies.finished_study import SEGMENTS


@pytest.fixture
def folder(own_study: OwnStudy) -> StudyFolder:
    return own_study("rating")


def stills(folder: StudyFolder) -> tuple[tuple[Still, ...], str]:
    study = folder.study()
    return study_stills(folder, study, folder.segments_of(study))


def test_every_condition_is_shown_at_the_same_moments_of_the_first_segment(
    folder: StudyFolder,
) -> None:
    found, reason = stills(folder)
    assert reason == ""
    assert {still.segment for still in found} == {min(SEGMENTS)}
    times = {
        condition: tuple(s.seconds for s in found if s.condition == condition)
        for condition in ("ours", "theirs", "real")
    }
    assert len(set(times.values())) == 1
    assert len(times["ours"]) == STILL_COUNT
    assert list(times["ours"]) == sorted(times["ours"])
    start, image = "data:image/webp;base64,", found[0].image
    assert image.startswith(start) and len(image) < 20_000
    with Image.open(io.BytesIO(base64.b64decode(image.removeprefix(start)))) as picture:
        assert max(picture.size) == STILL_PIXELS


def test_a_segment_with_all_videos_is_preferred_and_damaged_ones_are_left_out(
    folder: StudyFolder,
) -> None:
    first, second, *_ = sorted(SEGMENTS)
    study = folder.study()
    segments = folder.segments_of(study)
    (folder.videos / "ours" / f"{first}.mp4").unlink()
    (folder.videos / "theirs" / f"{second}.mp4").write_bytes(b"damaged")

    found, _ = study_stills(folder, study, segments)

    assert {still.segment for still in found} == {second}
    assert {still.condition for still in found} == {"ours", "real"}
    assert len(found) == 2 * STILL_COUNT


def test_without_videos_a_sentence_says_so(tiny_study: Path) -> None:
    assert stills(StudyFolder(tiny_study)) == ((), NO_VIDEOS)


def left_edge(picture: np.ndarray) -> int:
    """Return the position of the dark block."""
    return int(np.flatnonzero(picture[60, :, 0] < 120)[0])


def test_frames_match_their_moments(tmp_path: Path) -> None:
    video = write_block_video(tmp_path / "v.mkv", range(60))
    pictures = [np.asarray(one) for one in frames_at(video, (0.0, 0.5, 1.5, 99.0), 128)]
    assert [left_edge(one) for one in pictures] == pytest.approx([0, 15, 45, 59], abs=1)
