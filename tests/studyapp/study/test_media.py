from dataclasses import replace
from pathlib import Path

import pytest

from motion.errors import InputError
from motion.segment import write_segments
from studyapp.study.folder import StudyFolder
from studyapp.study.media import PairVideo, Stimuli, read_stimuli, write_stimuli
from tests.studyapp.conftest import OwnStudy
from tests.support.studies.redefining import redefine
from tests.support.studies.takes import write_speech


@pytest.fixture
def finished(own_study: OwnStudy) -> StudyFolder:
    return own_study("mismatch")


def segment_names(folder: StudyFolder) -> list[str]:
    return [segment.name for segment in folder.segments_of(folder.study())]


def allow_gaps(folder: StudyFolder) -> None:
    redefine(folder.root, ("participants = 3", "participants = 3\nallow_gaps = true"))


@pytest.mark.parametrize("has_speech", [False, True])
def test_an_incomplete_segment_is_dropped_only_if_the_study_allows_it(
    finished: StudyFolder, has_speech: bool
) -> None:
    if has_speech:
        table = [replace(each, wav="a.wav") for each in finished.segments_of(finished.study())]
        write_speech(finished.speech / "a.wav", 2.0)
        write_segments(finished.speech, table)
    (finished.videos / "theirs" / "two.mp4").unlink()
    assert segment_names(finished) == ["one", "three", "two"]

    allow_gaps(finished)
    assert segment_names(finished) == ["one", "three"]


def test_every_video_missing_from_a_condition_is_listed(finished: StudyFolder) -> None:
    for video in (finished.videos / "theirs").glob("*.mp4"):
        video.rename(video.with_name(f"other-{video.name}"))

    assert {"one", "other-one"} <= set(segment_names(finished))
    allow_gaps(finished)
    with pytest.raises(InputError, match="no segment has a finished video of every condition"):
        segment_names(finished)


def test_a_video_without_a_valid_name_is_reported(finished: StudyFolder) -> None:
    video = finished.videos / "ours" / "one.mp4"
    video.rename(video.with_name("one (1).mp4"))

    with pytest.raises(InputError, match=r"ours/one \(1\)\.mp4"):
        segment_names(finished)


def test_a_damaged_videos_segment_is_as_long_as_another_conditions_video(
    finished: StudyFolder,
) -> None:
    (finished.videos / "ours" / "one.mp4").write_bytes(b"no video")
    segments = finished.segments_of(finished.study())
    assert segments[0].end == pytest.approx(2.0, abs=0.05)

    for video in finished.videos.glob("*/one.mp4"):
        video.write_bytes(b"no video")
    with pytest.raises(InputError, match="this is not a playable video"):
        segment_names(finished)


PAIR = PairVideo(segment="s", left="a", right="b", file="videos/x.mp4", duration=2.0, key="k")


@pytest.mark.parametrize(
    ("content", "remedy"),
    [(None, "Run 'motionjury render'"), ("{", "Delete it"), ('{"pairs": [{}]}', "Delete it")],
)
def test_a_missing_or_damaged_stimuli_file_is_reported_with_a_remedy(
    tmp_path: Path, content: str | None, remedy: str
) -> None:
    path = tmp_path / "stimuli.json"
    if content is not None:
        path.write_text(content)
    with pytest.raises(InputError, match=rf"stimuli.json: .*{remedy}"):
        read_stimuli(path)


@pytest.mark.parametrize(
    "file",
    ["../secret.mp4", "videos/../../secret.mp4", "/etc/hostname", "videos/link.mp4", "a\0.mp4"],
)
def test_a_video_outside_the_study_is_refused_under_any_path(tmp_path: Path, file: str) -> None:
    study = tmp_path / "study"
    (study / "videos").mkdir(parents=True)
    (tmp_path / "secret.mp4").touch()
    (study / "videos" / "link.mp4").symlink_to(tmp_path / "secret.mp4")
    write_stimuli(
        study / "stimuli.json", Stimuli(pairs=(PAIR, PAIR.model_copy(update={"file": file})))
    )

    with pytest.raises(InputError, match="outside the study's folder"):
        read_stimuli(study / "stimuli.json")


def test_videos_may_be_on_another_disk(tmp_path: Path) -> None:
    study = tmp_path / "study"
    study.mkdir()
    (tmp_path / "disk").mkdir()
    (study / "videos").symlink_to(tmp_path / "disk")
    write_stimuli(study / "stimuli.json", Stimuli(pairs=(PAIR,)))

    assert read_stimuli(study / "stimuli.json").pairs == (PAIR,)
