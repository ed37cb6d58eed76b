"""Finished videos of any tool reach participants equal except in picture and sound."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio
from renderer.encoder import SOUND_RATE
from studyapp.preflight.check import check
from studyapp.preflight.finding import Severity
from studyapp.preflight.material import Material
from studyapp.preflight.sound_checks import sound_findings
from studyapp.preflight.video_checks import finished_video_findings, shown_video_findings
from studyapp.session.served_study import ServedStudy
from studyapp.stimuli.figures.contact_sheet import write_contact_sheet
from studyapp.stimuli.rendering import render
from studyapp.stimuli.video_copies import copy_videos
from studyapp.study.design.trial import Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media, read_stimuli
from tests.support.encoded import Told, write_video
from tests.support.studies.finished_study import write_finished_study
from tests.support.studies.redefining import redefine

LOUD = Audio((0.4 * np.sin(np.arange(2 * SOUND_RATE) / 20)).astype(np.float32), SOUND_RATE)
LONGER = Audio((0.1 * np.sin(np.arange(98_000) / 25)).astype(np.float32), SOUND_RATE)


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("video") / "usual.mp4"
    write_video(path, Told())
    return path


@pytest.fixture
def study(tmp_path: Path, usual: Path) -> Callable[..., StudyFolder]:
    """Return a function that makes a study with one video of 'ours' replaced."""

    def make(protocol: str = "rating", ours: Told | None = None) -> StudyFolder:
        write_finished_study(tmp_path, protocol, usual)
        folder = StudyFolder(tmp_path)
        if ours is not None:
            write_video(folder.videos / "ours" / "one.mp4", ours)
        return folder

    return make


def errors(folder: StudyFolder, severity: Severity = "error") -> list[str]:
    material = Material.read(folder, folder.study())
    findings = [
        *finished_video_findings(material),
        *shown_video_findings(material),
        *sound_findings(material),
    ]
    return [finding.what for finding in findings if finding.severity is severity]


def shown(folder: StudyFolder, condition: str, segment: str = "one") -> Path:
    video = Media.of(folder, folder.study()).find((Stimulus.own(condition, segment),))
    assert video is not None
    return video.file


def test_copies_do_not_reveal_their_condition(study: Callable[..., StudyFolder]) -> None:
    told = Told(name="groundtruth", language="jpn", frames=62)
    folder = study(ours=told)
    original = folder.videos / "ours" / "one.mp4"
    before = original.read_bytes()

    assert render(folder, processes=1).failures == ()

    files = [shown(folder, condition) for condition in ("ours", "theirs", "real")]
    assert len({file.stat().st_size for file in files}) == 1
    assert not any(b"groundtruth" in file.read_bytes() for file in files)
    assert not any(name in str(file) for file in files for name in ("ours", "theirs", "real"))
    lengths = set()
    for file in files:
        with av.open(str(file)) as container:
            lengths.add(container.duration)
    assert len(lengths) == 1
    assert original.read_bytes() == before
    assert errors(folder) == []


def test_a_changed_original_is_found_and_copied_again(study: Callable[..., StudyFolder]) -> None:
    folder = study(ours=Told(sound=LOUD))

    assert errors(folder) == [
        "the video of 'ours' for segment one has changed since it was copied for participants"
    ]
    assert render(folder, processes=1).made == 1
    assert errors(folder) == []


def test_copies_are_reused_and_a_newer_release_does_not_change_the_design(
    study: Callable[..., StudyFolder], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = study("mismatch")
    before = ServedStudy.read(folder.root).design
    copies = read_stimuli(folder.stimuli).copies
    assert copies and render(folder, processes=1).kept == len(copies)
    monkeypatch.setattr("studyapp.stimuli.video_copies.COPY_VERSION", "newer")

    assert render(folder, processes=1).made == len(copies)
    assert ServedStudy.read(folder.root).design == before


def test_a_misspelt_original_is_reported_with_a_suggestion(
    study: Callable[..., StudyFolder],
) -> None:
    folder = study()
    file = folder.videos / "theirs" / "two.mp4"
    file.rename(file.with_name("Two.mp4"))

    assert copy_videos(folder).failures == (
        "videos/theirs/two.mp4 is missing (is it videos/theirs/Two.mp4?)",
    )
    (missing,) = [finding for finding in check(folder) if finding.name == "video-missing"]
    assert missing.where == "videos/theirs/two.mp4"
    assert "Rename videos/theirs/Two.mp4" in missing.remedy
    sheet = write_contact_sheet(folder, threads=1).read_text("utf-8")
    assert "there is no video: add it" in sheet


def test_unused_copies_are_removed(study: Callable[..., StudyFolder]) -> None:
    folder = study("ranking")
    gone = shown(folder, "theirs", "two")
    redefine(folder.root, ('"theirs"]', '"real"]'), ('reference = "real"\n', ""))

    render(folder, processes=1)

    assert not gone.exists()
    assert (folder.videos / "theirs" / "two.mp4").exists()


@pytest.mark.parametrize(
    ("ours", "words"),
    [
        (Told(rate=25, frames=50), "the number of frames per second differs"),
        (Told(size=80), "the size of the picture differs"),
        (Told(codec="mpeg4"), "is encoded as mpeg4"),
        (Told(sound=None), "videos/ours/one.mp4 has no sound"),
        (Told(frames=80), "videos/ours/one.mp4 lasts 2.67 s, its segment 2.00 s"),
    ],
)
def test_differences_that_copying_cannot_remove_are_errors(
    study: Callable[..., StudyFolder], ours: Told, words: str
) -> None:
    # Without speech, a segment is as long as the first condition's video of it.
    folder = study()
    real = "[conditions.real]\nvideos = true\n"
    redefine(folder.root, (real, ""), ("[conditions.ours]", f"{real}[conditions.ours]"))
    write_video(folder.videos / "ours" / "one.mp4", ours)
    render(folder, processes=1)

    assert any(words in error for error in errors(folder))


@pytest.mark.parametrize(
    ("ours", "words"),
    [
        (Told(frames=62), "how many pictures there are"),
        (Told(encoder={"g": "10"}), "which pictures are encoded from which others"),
        (Told(encoder={"crf": "30"}), "settings of the encoder"),
        (Told(sound=LONGER), "how long the sound lasts"),
    ],
)
def test_differences_visible_only_to_tools_give_warnings(
    study: Callable[..., StudyFolder], ours: Told, words: str
) -> None:
    folder = study(ours=ours)
    render(folder, processes=1)

    warnings = [w for w in errors(folder, "warning") if w.startswith("whoever inspects")]

    assert [words in warning for warning in warnings] == [True]
