"""A folder of speech, motion and videos is imported by the names of its files."""

from pathlib import Path

import pytest

from motion.segment import Segment, write_segments
from studyapp.study.folder import StudyFolder
from tests.support.command_line import refused, run
from tests.support.encoded import VideoRecipe, write_video
from tests.support.studies.redefining import redefine
from tests.support.studies.takes import write_motion, write_speech

FACTS = ("--speaker", "ada", "--emotion", "anger")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """Return a folder with a take, speech alone, motion of both, and a video."""
    place = tmp_path / "source"
    for name in ("ground_truth", "ours", "filmed"):
        (place / name).mkdir(parents=True)
    write_speech(place / "alone.wav", 2.0)
    write_speech(place / "ground_truth" / "take.wav", 2.0)
    write_motion(place / "ground_truth" / "take.npz", 2.0)
    (place / "ground_truth" / "take.lab").write_text("good morning", "utf-8")
    for name in ("alone", "take"):
        write_motion(place / "ours" / f"{name}.npz", 2.0)
    write_video(place / "filmed" / "take.mp4", VideoRecipe())
    return place


@pytest.fixture
def folder(folder: StudyFolder) -> StudyFolder:
    """Return a study that compares finished videos."""
    text = folder.definition.read_text("utf-8")
    folder.definition.write_text(f'layout = "players"\n{text}', "utf-8")
    return folder


def test_everything_is_imported_by_segment_and_condition(folder: StudyFolder, source: Path) -> None:
    run("import", source, folder.root, *FACTS)
    segments = {segment.name: segment for segment in folder.segments()}
    assert set(segments) == {"alone", "take"}
    assert segments["take"].transcript == "good morning"
    assert (segments["alone"].speaker, segments["alone"].emotion) == ("ada", "anger")
    for condition, name in (("ground_truth", "take"), ("ours", "take"), ("ours", "alone")):
        assert folder.clip(condition, name).is_file()
    assert not folder.clip("ground_truth", "alone").exists()
    stored = folder.videos / "filmed" / "take.mp4"
    assert stored.read_bytes() == (source / "filmed" / "take.mp4").read_bytes()
    assert folder.study().is_finished("filmed")
    run("import", source, folder.root, *FACTS)


def test_names_that_the_study_file_cannot_hold_are_refused(
    folder: StudyFolder, source: Path
) -> None:
    redefine(folder.root, ('layout = "players"\n', ""))
    said = refused("import", source, folder.root, *FACTS)
    assert 'set layout = "players"' in said
    assert not folder.videos.exists()


def test_a_table_states_the_segments(folder: StudyFolder, tmp_path: Path) -> None:
    place = tmp_path / "speech"
    place.mkdir()
    write_speech(place / "talk.wav", 4.0)
    segments = [
        Segment(name=f"s{n}", wav="talk.wav", start=2.0 * n, end=2.0 * n + 2, speaker="eve",
                emotion=emotion)
        for n, emotion in enumerate(("fear", "anger"))
    ]  # fmt: skip
    write_segments(place, segments)
    run("import", place, folder.root, *FACTS)
    assert list(folder.segments()) == segments


def test_refused_items_stay_without_stopping_others(folder: StudyFolder, source: Path) -> None:
    (source / "ours" / "nobody.npz").write_bytes((source / "ours" / "take.npz").read_bytes())
    (source / "ours" / "take.npz").write_bytes(b"PK no archive")
    (source / "notes.docx").write_bytes(b"PK")
    said = refused("import", source, folder.root, *FACTS, "--move")
    for words in (
        "there is no segment 'nobody'",
        "take.npz: the file is not an .npz archive",
        "this is neither speech, motion nor a finished video",
        "3 of 7 items could not be imported",
    ):
        assert words in said
    left = {path.name for path in source.rglob("*") if path.is_file()}
    assert left == {"notes.docx", "nobody.npz", "take.npz"}
    assert folder.clip("ours", "alone").is_file()


NOT_PLAYED = "take.mp4: the video cannot be played"


@pytest.mark.parametrize(
    ("name", "content", "error"),
    [
        ("take.mp4", VideoRecipe(frames=90), "lasts 3.00 s, its segment 2.00 s"),
        ("take@nobody.mp4", VideoRecipe(), "there is no segment 'nobody'"),
        ("take.mp4", b"#EXTM3U\n", NOT_PLAYED),
        ("take.mp4", b"ffconcat version 1.0\nfile ../alone.wav\n", NOT_PLAYED),
    ],
)
def test_an_invalid_video_or_one_without_segment_is_refused(
    folder: StudyFolder, source: Path, name: str, content: VideoRecipe | bytes, error: str
) -> None:
    (source / "filmed" / "take.mp4").unlink()
    video = source / "filmed" / name
    if isinstance(content, bytes):
        video.write_bytes(content)
    else:
        write_video(video, content)

    assert error in refused("import", source, folder.root, *FACTS)
    assert not folder.videos.exists()
    assert "filmed" not in folder.study().conditions


def test_another_format_under_a_video_ending_is_refused(
    folder: StudyFolder, source: Path, tmp_path: Path
) -> None:
    write_video(tmp_path / "other.mkv", VideoRecipe())
    (tmp_path / "other.mkv").replace(source / "filmed" / "take.mp4")
    said = refused("import", source, folder.root, *FACTS)
    assert "take.mp4: the video is not an MP4 file" in said


def test_existing_videos_and_motion_are_never_replaced(folder: StudyFolder, source: Path) -> None:
    run("import", source, folder.root, *FACTS)
    write_video(source / "filmed" / "take.mp4", VideoRecipe(size=96))
    (source / "ours" / "take.mp4").write_bytes((source / "filmed" / "take.mp4").read_bytes())
    (source / "filmed" / "alone.npz").write_bytes((source / "ours" / "alone.npz").read_bytes())
    output = refused("import", source, folder.root, *FACTS)
    assert "already has another video for segment take" in output
    assert "condition 'ours' has motion instead of finished videos" in output
    assert "condition 'filmed' has finished videos instead of motion" in output


def test_missing_information_about_speech_and_motion_is_reported(
    folder: StudyFolder, source: Path, tmp_path: Path
) -> None:
    (source / "ours" / "take.npz").rename(source / "take.npz")
    said = refused("import", source, folder.root)
    assert "the speaker and the emotion are unknown" in said
    assert "the condition is unknown" in said
    (tmp_path / "empty").mkdir()
    assert "no file to import" in refused("import", tmp_path / "empty", folder.root)
