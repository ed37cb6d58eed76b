"""What participants would get, broken by hand in every way that is looked for."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from studyapp.preflight.catch_checks import catch_picture_findings
from studyapp.preflight.check import check
from studyapp.preflight.finished_video_checks import finished_video_findings
from studyapp.preflight.material import Material
from studyapp.preflight.shown_video_checks import (
    shown_video_findings,
    weight_findings,
    weight_of,
)
from studyapp.preflight.sound_checks import silent_share, sound_findings
from studyapp.study.design.trial import Content, PlannedTrial, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media
from tests.studyapp.conftest import OwnStudy
from tests.support.encoded import Told, write_video


def shown(folder: StudyFolder, condition: str, segment: str = "one", *, sound: bool = True) -> Path:
    """Return the file that participants get."""
    stimulus = Stimulus(condition=condition, segment=segment, speech=segment if sound else None)
    found = Media.of(folder, folder.study()).find((stimulus,))
    assert found is not None
    return found.file


def names(folder: StudyFolder) -> dict[str, str]:
    material = Material.of(folder, folder.study())
    found = [
        *finished_video_findings(material),
        *shown_video_findings(material),
        *sound_findings(material),
        *catch_picture_findings(material),
    ]
    return {each.name: each.what for each in found}


def test_a_misspelt_video_is_an_error_that_names_it(own_study: OwnStudy) -> None:
    study = own_study("rating")
    file = study.videos / "theirs" / "two.mp4"
    file.rename(file.with_name("Two.mp4"))

    missing = [each for each in check(study) if each.name == "video-missing"]

    assert [each.where for each in missing] == ["videos/theirs/two.mp4"]
    assert "Rename videos/theirs/Two.mp4" in missing[0].remedy


def rewritten(video: Path, *, sound: bool = True, silent: bool = False, **metadata: str) -> None:
    """Write a video anew."""
    draft = video.with_suffix(".draft.mp4")
    with (
        av.open(str(video)) as source,
        av.open(str(draft), "w") as target,
    ):
        target.metadata.update(metadata)
        wanted = [*source.streams.video, *(source.streams.audio if sound and not silent else [])]
        streams = {one.index: target.add_stream_from_template(one) for one in wanted}
        quiet = target.add_stream("aac", rate=SOUND_RATE, layout="mono") if silent else None
        for packet in source.demux(wanted):
            if packet.dts is not None:
                packet.stream = streams[packet.stream.index]
                target.mux(packet)
        if quiet is not None:
            frame = av.AudioFrame.from_ndarray(
                np.zeros((1, 2 * SOUND_RATE), np.float32), format="fltp", layout="mono"
            )
            frame.sample_rate, frame.pts = SOUND_RATE, 0
            target.mux([*quiet.encode(frame), *quiet.encode(None)])
    draft.replace(video)


def test_a_whole_study_has_nothing_but_small_pictures(own_study: OwnStudy) -> None:
    assert set(names(own_study("rating"))) == {"picture-small", "frame-rate-low"}


FREE_BOX = (12).to_bytes(4, "big") + b"free" + bytes(4)


@pytest.mark.parametrize(
    ("spoil", "name", "said"),
    [
        (lambda file: file.write_bytes(b"no video"), "video-damaged", "cannot be played"),
        (lambda file: file.write_bytes(file.read_bytes()[:400]), "sound-missing", "has no sound"),
        (lambda file: file.write_bytes(file.read_bytes() + FREE_BOX), "sizes-differ", "file size"),
        (partial(rewritten, title="render of Ours v2"), "metadata-tells", "'ours'"),
        (partial(rewritten, comment="take 3"), "metadata-tells", "other videos of"),
        (lambda file: write_video(file, Told(frames=62, size=120)), "lengths-differ", "to 2.07 s"),
        (partial(rewritten, sound=False), "sound-missing", "has no sound"),
        (partial(rewritten, silent=True), "sound-silent", "videos/ours/one.mp4 is silent"),
    ],
)
def test_what_a_file_tells_or_lacks_is_told(
    own_study: OwnStudy, spoil: Callable[[Path], object], name: str, said: str
) -> None:
    study = own_study("rating")
    spoil(shown(study, "ours"))

    assert said in names(study)[name]


def test_sound_where_none_belongs_is_told(own_study: OwnStudy) -> None:
    study = own_study("mismatch")
    shutil.copyfile(shown(study, "ours"), shown(study, "ours", sound=False))

    assert "is to be shown without" in names(study)["sound-unwanted"]


def test_loudness_within_a_page_is_told_apart_from_loudness_between_pages(
    own_study: OwnStudy,
) -> None:
    study = own_study("rating")
    loud = Audio((0.4 * np.sin(np.arange(2 * SOUND_RATE) / 20)).astype(np.float32), SOUND_RATE)
    for condition in ("ours", "theirs", "real"):
        write_video(shown(study, condition), Told(sound=loud))
    assert {"loudness-differs"} <= set(names(study)) - {"loudness-differs-beside"}
    shutil.copyfile(shown(study, "real", "two"), shown(study, "real"))

    said = names(study)

    assert "louder than videos/real/one.mp4" in said["loudness-differs-beside"]
    assert "loudness-differs" not in said


def test_silence_is_counted_in_blocks() -> None:
    speech = np.zeros(SOUND_RATE, np.float32)
    assert silent_share(Audio(speech, SOUND_RATE)) == 1.0
    speech[: SOUND_RATE // 4] = 0.1

    assert silent_share(Audio(speech, SOUND_RATE)) == pytest.approx(0.7, abs=0.05)


def test_videos_of_catch_trials_that_look_alike_are_told(own_study: OwnStudy) -> None:
    study = own_study("pairwise")
    assert "hardly differ in 3 of 3 segments" in names(study)["catch-hardly-differs"]
    for segment in ("one", "two", "three"):
        write_video(study.videos / "broken" / f"{segment}.mp4", Told(size=120))

    assert "catch-hardly-differs" not in names(study)


def trial(position: int, *videos: str) -> PlannedTrial:
    return PlannedTrial(
        position=position,
        kind="main",
        segment=Segment(name="s", wav="s.wav", start=0.0, end=1.0, speaker="", emotion="neutral"),
        videos=tuple((Stimulus.own(video, "s"),) for video in videos),
    )


SIZES: Mapping[Content, int] = {
    (Stimulus.own(name, "s"),): size for name, size in (("a", 10), ("b", 20), ("c", 100))
}


def test_a_page_weighs_its_own_videos_and_those_of_the_next() -> None:
    plan = [trial(1, "a", "b"), trial(2, "b", "c"), trial(3, "a", "a")]

    assert weight_of(plan, SIZES) == (150, 170)


@pytest.mark.parametrize(("allowed", "errors"), [("60", 0), ("0.001", 1)])
def test_a_page_above_the_budget_is_an_error_with_a_remedy(
    own_study: OwnStudy, allowed: str, errors: int
) -> None:
    folder = own_study("rating")
    with folder.definition.open("a") as file:
        file.write(f"\n[watching]\nmegabytes_per_page = {allowed}\n")

    findings = list(weight_findings(Material.of(folder, folder.study())))

    said = [finding for finding in findings if finding.severity == "error"]
    assert len(said) == errors
    assert findings[0].what.startswith("a page loads up to 0.")
    assert all("megabytes_per_page" in f.what and "smaller" in f.remedy for f in said)
