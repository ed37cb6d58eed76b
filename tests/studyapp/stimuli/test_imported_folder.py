"""A folder of speech, motion and videos comes into a study by the names of its files."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from motion.errors import InputError
from motion.segment import Segment, write_segments
from studyapp.cli.main import group
from studyapp.stimuli.imported_folder import folder_items
from studyapp.stimuli.recordings import RecordingFacts
from studyapp.study.folder import StudyFolder
from tests.support.encoded import Told, write_video
from tests.support.studies.takes import write_motion, write_speech

WHO = ("--speaker", "ada", "--emotion", "anger")


@pytest.fixture
def brought(tmp_path: Path) -> Path:
    """Return a folder of a take, speech alone, motion of both, and a video."""
    place = tmp_path / "brought"
    for name in ("ground_truth", "ours", "filmed"):
        (place / name).mkdir(parents=True)
    write_speech(place / "alone.wav", 2.0)
    write_speech(place / "ground_truth" / "take.wav", 2.0)
    write_motion(place / "ground_truth" / "take.npz", 2.0)
    (place / "ground_truth" / "take.lab").write_text("good morning", "utf-8")
    for name in ("alone", "take"):
        write_motion(place / "ours" / f"{name}.npz", 2.0)
    write_video(place / "filmed" / "take.mp4", Told())
    return place


@pytest.fixture
def folder(folder: StudyFolder) -> StudyFolder:
    """Return a study in which finished videos may stand beside each other."""
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(f'layout = "players"\n{text}', "utf-8")
    return folder


def bring(place: Path, folder: StudyFolder, *options: str) -> Result:
    return CliRunner().invoke(group, ["import", str(place), str(folder.root), *WHO, *options])


def left(place: Path) -> set[str]:
    return {path.relative_to(place).as_posix() for path in place.rglob("*") if path.is_file()}


def test_everything_comes_in_under_its_segment_and_condition(
    folder: StudyFolder, brought: Path
) -> None:
    done = bring(brought, folder)
    assert done.exit_code == 0, done.output
    segments = {one.name: one for one in folder.segments()}
    assert set(segments) == {"alone", "take"}
    assert segments["take"].transcript == "good morning"
    assert (segments["alone"].speaker, segments["alone"].emotion) == ("ada", "anger")
    for condition, name in (("ground_truth", "take"), ("ours", "take"), ("ours", "alone")):
        assert folder.clip(condition, name).is_file()
    assert not folder.clip("ground_truth", "alone").exists()
    stored = folder.videos / "filmed" / "take.mp4"
    assert stored.read_bytes() == (brought / "filmed" / "take.mp4").read_bytes()
    assert folder.study().is_finished("filmed")
    again = bring(brought, folder)
    assert again.exit_code == 0, again.output


def test_nothing_is_stored_that_the_study_file_does_not_take(
    folder: StudyFolder, brought: Path
) -> None:
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(text.replace('layout = "players"\n', ""), "utf-8")
    assert 'set layout = "players"' in bring(brought, folder).output
    assert not folder.videos.exists()


def test_a_table_says_who_speaks_where(folder: StudyFolder, tmp_path: Path) -> None:
    place = tmp_path / "speech"
    place.mkdir()
    write_speech(place / "talk.wav", 4.0)
    told = [
        Segment(name=f"s{n}", wav="talk.wav", start=2.0 * n, end=2.0 * n + 2, speaker="eve",
                emotion=emotion)
        for n, emotion in enumerate(("fear", "anger"))
    ]  # fmt: skip
    write_segments(place, told)
    done = bring(place, folder)
    assert done.exit_code == 0, done.output
    assert list(folder.segments()) == told


def test_what_is_refused_keeps_nothing_else_out_and_stays(
    folder: StudyFolder, brought: Path
) -> None:
    (brought / "ours" / "nobody.npz").write_bytes((brought / "ours" / "take.npz").read_bytes())
    (brought / "ours" / "take.npz").write_bytes(b"PK no archive")
    (brought / "notes.docx").write_bytes(b"PK")
    done = bring(brought, folder, "--move")
    assert done.exit_code == 1
    assert "no segment is called 'nobody'" in done.output
    assert "take.npz: the file is not an .npz archive" in done.output
    assert "this is neither speech, motion nor a finished video" in done.output
    assert "3 of 7 could not be brought in" in done.output
    assert left(brought) == {"notes.docx", "ours/nobody.npz", "ours/take.npz"}
    assert folder.clip("ours", "alone").is_file()


NOT_PLAYED = "take.mp4: the video cannot be played"


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("take.mp4", Told(frames=90), "lasts 3.00 s, its segment 2.00 s"),
        ("nobody.mp4", Told(), "no segment is called 'nobody'"),
        ("take@nobody.mp4", Told(), "no segment is called 'nobody'"),
        ("take.mp4", b"", NOT_PLAYED),
        ("take.mp4", b"#EXTM3U\n", NOT_PLAYED),
        ("take.mp4", b"ffconcat version 1.0\nfile ../alone.wav\n", NOT_PLAYED),
    ],
)
def test_a_video_that_is_none_or_shows_no_segment_is_refused(
    folder: StudyFolder, brought: Path, name: str, content: Told | bytes, said: str
) -> None:
    (brought / "filmed" / "take.mp4").unlink()
    video = brought / "filmed" / name
    if isinstance(content, bytes):
        video.write_bytes(content)
    else:
        write_video(video, content)

    assert said in bring(brought, folder).output
    assert not folder.videos.exists()
    assert "filmed" not in folder.study().conditions


def test_another_video_or_motion_never_takes_the_place_of_one(
    folder: StudyFolder, brought: Path
) -> None:
    bring(brought, folder)
    write_video(brought / "filmed" / "take.mp4", Told(size=96))
    (brought / "ours" / "take.mp4").write_bytes((brought / "filmed" / "take.mp4").read_bytes())
    (brought / "filmed" / "alone.npz").write_bytes((brought / "ours" / "alone.npz").read_bytes())
    said = bring(brought, folder).output
    assert "has another video for segment take already" in said
    assert "condition 'ours' has motion, no finished videos" in said
    assert "condition 'filmed' has finished videos, no motion" in said


def test_speech_and_motion_without_what_they_need_say_so(
    folder: StudyFolder, brought: Path, tmp_path: Path
) -> None:
    (brought / "ours" / "take.npz").rename(brought / "take.npz")
    items = folder_items(folder, brought, RecordingFacts())
    said = []
    for item in items:
        try:
            item.bring_in()
        except InputError as error:
            said.append(str(error))
    assert any("nothing says who speaks" in one for one in said)
    assert any("nothing says of which condition this is" in one for one in said)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no file to bring in"):
        folder_items(folder, tmp_path / "empty", RecordingFacts())
