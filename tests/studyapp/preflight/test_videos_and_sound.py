"""Videos of participants, broken in every way that is checked."""

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio
from renderer.encoder import SOUND_RATE
from studyapp.preflight.material import Material
from studyapp.preflight.sound_checks import sound_findings
from studyapp.preflight.video_checks import (
    finished_video_findings,
    shown_video_findings,
    weight_findings,
    weight_of,
)
from studyapp.study.design.trial import Content, PlannedTrial, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media
from tests.studyapp.conftest import OwnStudy
from tests.support.encoded import VideoRecipe, write_video
from tests.support.studies.made_study import make_segments


def participant_file(
    folder: StudyFolder, condition: str, segment: str = "one", *, sound: bool = True
) -> Path:
    stimulus = Stimulus(condition=condition, segment=segment, speech=segment if sound else None)
    video = Media.of(folder, folder.study()).find((stimulus,))
    assert video is not None
    return video.file


def check_videos(folder: StudyFolder) -> dict[str, str]:
    material = Material.read(folder, folder.study())
    findings = [
        *finished_video_findings(material),
        *shown_video_findings(material),
        *sound_findings(material),
    ]
    return {finding.name: finding.what for finding in findings}


def test_the_only_finding_of_an_intact_study_is_small_pictures(own_study: OwnStudy) -> None:
    assert set(check_videos(own_study("rating"))) == {"picture-small", "frame-rate-low"}


SILENCE = Audio(np.zeros(2 * SOUND_RATE, np.float32), SOUND_RATE)
FREE_BOX = (12).to_bytes(4, "big") + b"free" + bytes(4)


@pytest.mark.parametrize(
    ("spoil", "name", "words"),
    [
        (lambda file: file.write_bytes(b"no video"), "video-damaged", "cannot be played"),
        (lambda file: file.write_bytes(file.read_bytes() + FREE_BOX), "sizes-differ", "file size"),
        (VideoRecipe(name="render of Ours v2"), "metadata-tells", "Ours v2'"),
        (VideoRecipe(frames=62), "lengths-differ", "to 2.07 s"),
        (VideoRecipe(sound=None), "sound-missing", "has no sound"),
        (VideoRecipe(sound=SILENCE), "sound-silent", "videos/ours/one.mp4 is silent"),
    ],
)
def test_revealing_or_missing_properties_of_a_file_are_found(
    own_study: OwnStudy, spoil: Callable[[Path], object] | VideoRecipe, name: str, words: str
) -> None:
    study = own_study("rating")
    file = participant_file(study, "ours")
    if isinstance(spoil, VideoRecipe):
        write_video(file, spoil)
    else:
        spoil(file)

    assert words in check_videos(study)[name]


def test_loudness_is_compared_within_a_segment_before_between_segments(own_study: OwnStudy) -> None:
    study = own_study("rating")
    loud = Audio((0.4 * np.sin(np.arange(2 * SOUND_RATE) / 20)).astype(np.float32), SOUND_RATE)
    for condition in ("ours", "theirs", "real"):
        write_video(participant_file(study, condition), VideoRecipe(sound=loud))
    assert {"loudness-differs"} <= set(check_videos(study)) - {"loudness-differs-beside"}
    shutil.copyfile(participant_file(study, "real", "two"), participant_file(study, "real"))

    findings = check_videos(study)

    assert "louder than videos/real/one.mp4" in findings["loudness-differs-beside"]
    assert "loudness-differs" not in findings


def test_page_weight_includes_the_next_pages_videos() -> None:
    (segment,) = make_segments(["neutral"])
    shown: dict[str, Content] = {name: (Stimulus.own(name, segment.name),) for name in "abc"}
    plan = [
        PlannedTrial(position=0, kind="main", segment=segment, videos=(shown[a], shown[b]))
        for a, b in ("ab", "bc", "aa")
    ]

    sizes = {shown["a"]: 10, shown["b"]: 20, shown["c"]: 100}
    assert weight_of(plan, sizes) == (150, 170)


@pytest.mark.parametrize(("allowed", "errors"), [("60", 0), ("0.001", 1)])
def test_a_page_above_the_limit_is_an_error_with_a_remedy(
    own_study: OwnStudy, allowed: str, errors: int
) -> None:
    folder = own_study("rating")
    with folder.definition.open("a") as file:
        file.write(f"\n[watching]\nmegabytes_per_page = {allowed}\n")

    findings = list(weight_findings(Material.read(folder, folder.study())))

    heavy = [finding for finding in findings if finding.severity == "error"]
    assert len(heavy) == errors
    assert findings[0].what.startswith("a page loads up to 0.")
    assert all("megabytes_per_page" in f.what and "smaller" in f.remedy for f in heavy)
