"""Finished videos of any tool reach participants equal except in picture and sound."""

from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio
from renderer.encoder import SOUND_RATE
from studyapp.preflight.check import check
from studyapp.session.served_study import ServedStudy
from studyapp.stimuli.figures.contact_sheet import write_contact_sheet
from studyapp.stimuli.rendering import render
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.design.trial import Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media, read_stimuli
from tests.studyapp.conftest import OwnStudy
from tests.support.encoded import VideoRecipe, write_video
from tests.support.studies.finished_study import write_finished_study
from tests.support.studies.redefining import redefine


@pytest.fixture
def study(tmp_path: Path) -> StudyFolder:
    """Return a study of ratings whose finished videos are encoded alike."""
    write_video(tmp_path / "usual.mp4", VideoRecipe())
    folder = StudyFolder(tmp_path / "study")
    folder.root.mkdir()
    write_finished_study(folder.root, "rating", tmp_path / "usual.mp4")
    return folder


def write_original(folder: StudyFolder, recipe: VideoRecipe) -> Path:
    """Replace the finished video of 'ours' for the first segment."""
    file = folder.videos / "ours" / "one.mp4"
    write_video(file, recipe)
    return file


def errors(folder: StudyFolder) -> list[str]:
    return [finding.what for finding in check(folder) if finding.severity == "error"]


def shown(folder: StudyFolder, condition: str, segment: str = "one") -> Path:
    video = Media.of(folder, folder.study()).find((Stimulus.own(condition, segment),))
    assert video is not None
    return video.file


def test_copies_do_not_reveal_their_condition(study: StudyFolder) -> None:
    original = write_original(study, VideoRecipe(name="groundtruth", language="jpn", frames=62))
    before = original.read_bytes()

    assert render(study, processes=1).failures == ()

    files = [shown(study, condition) for condition in ("ours", "theirs", "real")]
    assert len({file.stat().st_size for file in files}) == 1
    assert not any(b"groundtruth" in file.read_bytes() for file in files)
    assert not any(name in str(file) for file in files for name in ("ours", "theirs", "real"))
    lengths = set()
    for file in files:
        with av.open(str(file)) as container:
            lengths.add(container.duration)
    assert len(lengths) == 1
    assert original.read_bytes() == before
    assert errors(study) == []


def test_a_changed_original_is_found_and_copied_again(study: StudyFolder) -> None:
    write_original(study, VideoRecipe(name="another"))

    assert errors(study) == [
        "the video of 'ours' for segment one has changed since it was copied for participants"
    ]
    assert render(study, processes=1).made == 1
    assert errors(study) == []


def test_copies_are_reused_and_a_newer_release_does_not_change_the_design(
    own_study: OwnStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = own_study("mismatch")
    before = ServedStudy.read(folder.root).design
    copies = read_stimuli(folder.stimuli).copies
    assert copies and render(folder, processes=1).kept == len(copies)
    monkeypatch.setattr("studyapp.stimuli.video_copies.COPY_VERSION", "newer")

    assert render(folder, processes=1).made == len(copies)
    assert ServedStudy.read(folder.root).design == before


def test_a_misspelt_original_is_reported_with_a_suggestion(own_study: OwnStudy) -> None:
    folder = own_study("rating")
    file = folder.videos / "theirs" / "two.mp4"
    file.rename(file.with_name("Two.mp4"))

    assert copy_videos(folder).failures == ("videos/theirs/two.mp4 is missing",)
    (missing,) = [finding for finding in check(folder) if finding.name == "video-missing"]
    assert missing.where == "videos/theirs/two.mp4"
    assert "Rename videos/theirs/Two.mp4" in missing.remedy
    sheet = write_contact_sheet(folder, threads=1).read_text("utf-8")
    assert "there is no video: add it" in sheet


def test_unused_copies_are_removed(own_study: OwnStudy) -> None:
    folder = own_study("ranking")
    gone = shown(folder, "theirs", "two")
    redefine(folder.root, ('"theirs"]', '"real"]'), ('reference = "real"\n', ""))

    render(folder, processes=1)

    assert not gone.exists()
    assert (folder.videos / "theirs" / "two.mp4").exists()


LONGER = Audio((0.1 * np.sin(np.arange(98_000) / 25)).astype(np.float32), SOUND_RATE)


@pytest.mark.parametrize(
    ("original", "name", "words"),
    [
        (VideoRecipe(rate=25, frames=50), "frame-rate-differs", "25.0 in videos/ours/one.mp4"),
        (VideoRecipe(size=80), "picture-size-differs", "80 × 80 in videos/ours/one.mp4"),
        (VideoRecipe(codec="mpeg4"), "video-unplayable", "is encoded as mpeg4"),
        (VideoRecipe(sound=None), "sound-missing", "videos/ours/one.mp4 has no sound"),
        (VideoRecipe(frames=80), "video-length", "one.mp4 lasts 2.67 s, its segment 2.00 s"),
        # What only tools see.
        (VideoRecipe(frames=62), "structure-tells", "how many pictures there are"),
        (VideoRecipe(encoder={"g": "10"}), "structure-tells", "encoded from which others"),
        (VideoRecipe(encoder={"crf": "30"}), "structure-tells", "settings of the encoder"),
        (VideoRecipe(sound=LONGER), "structure-tells", "how long the sound lasts"),
    ],
)
def test_differences_that_copying_cannot_remove_are_found(
    study: StudyFolder, original: VideoRecipe, name: str, words: str
) -> None:
    # Without speech, a segment is as long as the first condition's video of it.
    real = "[conditions.real]\nvideos = true\n"
    redefine(study.root, (real, ""), ("[conditions.ours]", f"{real}[conditions.ours]"))
    write_original(study, original)
    render(study, processes=1)

    assert [finding.name for finding in check(study) if words in finding.what] == [name]
