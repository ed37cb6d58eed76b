"""What participants would get, broken by hand in every way that is looked for."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

import av
import numpy as np
import pytest

from motion.audio import Audio
from motion.segment import Segment
from renderer.encoder import SOUND_RATE
from studyapp.preflight.catch_checks import catch_picture_findings
from studyapp.preflight.check import check, finished_videos
from studyapp.preflight.finished_video_checks import finished_video_findings
from studyapp.preflight.material import Material
from studyapp.preflight.shown_video_checks import (
    Weight,
    shown_video_findings,
    weight_findings,
    weight_of,
)
from studyapp.preflight.sound_checks import silent_share, sound_findings
from studyapp.stimuli.media_probe import plays_at_once, written_in
from studyapp.study.design.trial import Content, PlannedTrial, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media
from tests.encoded import Told, write_video
from tests.finished_study import write_finished_study, write_short_video


@pytest.fixture
def folder(finished_study: Callable[[str], Path], tmp_path: Path) -> Callable[[str], StudyFolder]:
    def copy(protocol: str) -> StudyFolder:
        return StudyFolder(Path(shutil.copytree(finished_study(protocol), tmp_path / protocol)))

    return copy


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


def test_a_misspelt_video_is_an_error_that_names_it_and_a_gap_in_the_table(
    folder: Callable[[str], StudyFolder],
) -> None:
    study = folder("rating")
    first, second, *_ = study.study().conditions
    file = study.videos / second / "two.mp4"
    file.rename(file.with_name("Two.mp4"))

    missing = [each for each in check(study) if each.name == "video-missing"]

    assert [each.where for each in missing] == [f"videos/{second}/two.mp4"]
    assert f"Rename videos/{second}/Two.mp4" in missing[0].remedy
    heading, row, _ = finished_videos(study)
    assert heading.split()[:3] == ["segment", first, second]
    assert row.split()[:3] == ["two", "yes", "MISSING"]
    assert len(finished_videos(study, everything=True)) == len(study.segments_of(study.study())) + 2


def rewritten(
    video: Path, *, sound: bool = True, silent: bool = False, options: dict[str, str] | None = None,
    **metadata: str,
) -> None:  # fmt: skip
    """Write a video anew: its index behind its pictures unless `options` say otherwise."""
    draft = video.with_suffix(".draft.mp4")
    with av.open(str(video)) as source, av.open(str(draft), "w", options=options or {}) as target:
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


def test_a_whole_study_has_nothing_but_small_pictures(folder: Callable[[str], StudyFolder]) -> None:
    assert set(names(folder("rating"))) == {"picture-small", "frame-rate-low"}


def test_an_index_behind_the_pictures_is_told(folder: Callable[[str], StudyFolder]) -> None:
    study = folder("rating")
    video = shown(study, "ours")
    assert plays_at_once(video) is True
    rewritten(video)

    assert plays_at_once(video) is False
    assert video.name in names(study)["loads-before-playing"]


def test_what_a_file_says_of_its_condition_is_told(folder: Callable[[str], StudyFolder]) -> None:
    study = folder("rating")
    rewritten(shown(study, "ours"), options={"movflags": "+faststart"}, title="render of Ours v2")

    assert "which names the condition 'ours'" in names(study)["metadata-tells"]
    assert any("render of Ours" in text for text in written_in(shown(study, "ours")))


def test_what_only_one_file_says_is_told(folder: Callable[[str], StudyFolder]) -> None:
    study = folder("rating")
    rewritten(shown(study, "theirs"), options={"movflags": "+faststart"}, comment="take 3")

    assert "which other videos of segment one do not" in names(study)["metadata-tells"]


def test_a_video_that_lasts_longer_than_those_beside_it_is_told(
    folder: Callable[[str], StudyFolder],
) -> None:
    study = folder("rating")
    write_video(shown(study, "ours"), Told(frames=62, size=120))

    assert "last from 2.00 to 2.07 s" in names(study)["lengths-differ"]


def test_sound_where_none_belongs_is_told(folder: Callable[[str], StudyFolder]) -> None:
    study = folder("mismatch")
    shutil.copyfile(shown(study, "ours"), shown(study, "ours", sound=False))

    assert "is to be shown without" in names(study)["sound-unwanted"]


def test_missing_sound_and_silence_are_told(folder: Callable[[str], StudyFolder]) -> None:
    study = folder("rating")
    rewritten(shown(study, "ours"), sound=False)
    rewritten(shown(study, "theirs"), silent=True)

    said = names(study)

    assert "has no sound" in said["sound-missing"]
    assert "videos/theirs/one.mp4 is silent" in said["sound-silent"]


def test_loudness_within_a_page_is_told_apart_from_loudness_between_pages(
    folder: Callable[[str], StudyFolder],
) -> None:
    study = folder("rating")
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


def test_videos_of_catch_trials_that_look_alike_are_told(
    folder: Callable[[str], StudyFolder],
) -> None:
    study = folder("pairwise")
    assert "hardly differ in 3 of 3 segments" in names(study)["catch-hardly-differs"]
    for segment in ("one", "two", "three"):
        write_video(study.videos / "broken" / f"{segment}.mp4", Told(size=120))

    assert "catch-hardly-differs" not in names(study)


def trial(position: int, *videos: str, reference: str | None = None) -> PlannedTrial:
    return PlannedTrial(
        position=position,
        kind="main",
        segment=Segment(name="s", wav="s.wav", start=0.0, end=1.0, speaker="", emotion="neutral"),
        videos=tuple((Stimulus.own(video, "s"),) for video in videos),
        reference=None if reference is None else Stimulus.own(reference, "s"),
    )


SIZES: Mapping[Content, int] = {
    (Stimulus.own(name, "s"),): size for name, size in (("a", 10), ("b", 20), ("c", 100))
}


def test_a_page_weighs_its_own_videos_and_those_of_the_next() -> None:
    plan = [trial(1, "a", "b"), trial(2, "b", "c"), trial(3, "a", "a")]

    assert weight_of(plan, SIZES) == Weight(heaviest=150, total=170)


def test_a_reference_weighs_as_well() -> None:
    assert weight_of([trial(1, "a", reference="c")], SIZES) == Weight(heaviest=110, total=110)


def test_no_trials_weigh_nothing() -> None:
    assert weight_of([], SIZES) == Weight(heaviest=0, total=0)


@pytest.mark.parametrize(("allowed", "errors"), [("60", 0), ("0.001", 1)])
def test_a_page_above_the_budget_is_an_error_with_a_remedy(
    tmp_path: Path, allowed: str, errors: int
) -> None:
    write_short_video(tmp_path / "short.mp4")
    write_finished_study(tmp_path, "rating", tmp_path / "short.mp4")
    folder = StudyFolder(tmp_path)
    with folder.definition.open("a") as file:
        file.write(f"\n[watching]\nmegabytes_per_page = {allowed}\n")

    findings = list(weight_findings(Material.of(folder, folder.study())))

    said = [finding for finding in findings if finding.severity == "error"]
    assert len(said) == errors
    assert findings[0].what.startswith("a page loads up to 0.")
    assert all("megabytes_per_page" in f.what and "smaller" in f.remedy for f in said)
