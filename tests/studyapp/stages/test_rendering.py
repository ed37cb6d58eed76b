from __future__ import annotations

import shutil
from collections import namedtuple
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import av
import numpy as np
import pytest
import tomlkit

from motion.audio import Audio, read_audio, write_wav
from motion.errors import InputError
from motion.formats import read_clip, write_clip
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import read_stimuli
from studyapp.stages.generation import generate
from studyapp.stages.recordings import Take, import_take
from studyapp.stages.render_record import RenderProgress
from studyapp.stages.rendering import render

pytestmark = pytest.mark.slow

Disk = namedtuple("Disk", "total used free")


@pytest.fixture
def study(folder: StudyFolder, take: Callable[..., Take]) -> StudyFolder:
    import_take(folder, take(speech=2.0, motion=2.0, segment=1.0))
    document = tomlkit.parse(folder.definition.read_text())
    document["video"].update({"size": 96, "frame_rate": 10})  # type: ignore[union-attr]
    folder.definition.write_text(tomlkit.dumps(document))
    generate(folder)
    return folder


def videos_of(folder: StudyFolder) -> Iterator[Path]:
    stimuli = read_stimuli(folder.stimuli)
    return (folder.root / record.file for record in (*stimuli.clips, *stimuli.pairs))


def test_every_clip_and_both_orders_of_every_pair_are_rendered(study: StudyFolder) -> None:
    told: list[RenderProgress] = []
    count = render(study, processes=1, on_progress=told.append)
    assert count.failures == ()
    assert count.notes == ()
    assert (count.made, count.kept) == (8 + 12, 0)
    assert (told[0].videos, told[0].frames) == (0, 0)
    assert (told[-1].videos, told[-1].all_videos, told[-1].failed) == (20, 20, 0)
    assert told[-1].frames == told[-1].all_frames == 20 * 10
    stimuli = read_stimuli(study.stimuli)
    for segment in study.segments():
        for left, right in study.study().pairs:
            pair = stimuli.pair(segment.name, left, right)
            assert pair is not None
            with av.open(str(study.root / pair.file)) as video:
                stream = video.streams.video[0]
                assert (stream.width, stream.height) == (192, 96)
                assert sum(1 for _ in video.decode(stream)) == 10


def test_neither_name_nor_size_of_a_pair_tells_what_it_shows(study: StudyFolder) -> None:
    render(study, processes=1)
    stimuli = read_stimuli(study.stimuli)
    names = [*study.study().conditions, "broken", "take"]
    for segment in study.segments():
        files = [study.root / p.file for p in stimuli.pairs if p.segment == segment.name]
        assert len({file.stat().st_size for file in files}) == 1
        for file in files:
            assert not any(name in file.name for name in names)
            assert not any(name.encode() in file.read_bytes() for name in names)


def test_a_second_run_renders_nothing_and_changed_clips_only_what_shows_them(
    study: StudyFolder,
) -> None:
    render(study, processes=1)
    before = {path: path.stat().st_mtime_ns for path in videos_of(study)}
    assert render(study, processes=1).made == 0
    assert {path: path.stat().st_mtime_ns for path in videos_of(study)} == before

    # Exchanged clips leave the framing, which all clips decide together, as it was.
    one, two = (study.clip("mismatched", segment.name) for segment in study.segments())
    content = one.read_bytes(), two.read_bytes()
    two.write_bytes(content[0])
    one.write_bytes(content[1])
    count = render(study, processes=1)
    assert count.made == 2 * (1 + 2)
    assert count.kept == 14


def test_an_interrupted_run_goes_on_where_it_was(study: StudyFolder) -> None:
    def interrupt(progress: RenderProgress) -> None:
        if progress.videos == 10:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render(study, processes=1, on_progress=interrupt)
    count = render(study, processes=1)
    assert count.kept >= 10
    assert count.made + count.kept == 20


def test_a_missing_clip_is_named_before_anything_is_rendered(study: StudyFolder) -> None:
    study.clip("mismatched", "take_02").unlink()
    with pytest.raises(InputError, match=r"1 of 8 .*'mismatched' for segment take_02.*generate"):
        render(study, processes=1)
    assert not study.videos.exists()


def test_a_study_without_any_usable_clip_is_refused(study: StudyFolder) -> None:
    for condition in study.study().conditions:
        for segment in study.segments():
            study.clip(condition, segment.name).write_text("torn")
    with pytest.raises(InputError, match=r"take_01\.npz: the file is no \.npz archive"):
        render(study, processes=1)
    assert not study.videos.exists()


def test_a_face_that_the_body_cannot_show_is_said(study: StudyFolder) -> None:
    text = study.definition.read_text("utf-8")
    moving = text.replace('freeze = ["face", ', "freeze = [")
    assert moving != text
    study.definition.write_text(moving, "utf-8")
    path = study.clip("mismatched", "take_01")
    clip = read_clip(path)
    faces = np.full((len(clip), 100), 0.5)
    write_clip(path, replace(clip, expressions=faces, arkit=None))
    (note,) = render(study, processes=1).notes
    assert note.startswith("mismatched: the clip's face is given as SMPL-X expression")


def _block_video(study: StudyFolder) -> None:
    (study.videos / "clips" / "mismatched" / "take_01.mp4").mkdir(parents=True)


def _truncate_clip(study: StudyFolder) -> None:
    path = study.clip("mismatched", "take_01")
    path.write_bytes(path.read_bytes()[:2000])


def _lengthen_clip(study: StudyFolder) -> None:
    path = study.clip("mismatched", "take_01")
    clip = read_clip(path)
    write_clip(path, replace(clip, frame_rate=clip.frame_rate / 2))


def test_speech_that_cannot_be_read_is_reported_video_by_video(study: StudyFolder) -> None:
    (study.speech / "take.wav").write_bytes(b"no sound")
    count = render(study, processes=1)
    assert (len(count.failures), count.left_out, count.made) == (8, 12, 0)
    assert all("take.wav" in failure for failure in count.failures)


@pytest.mark.parametrize("break_it", [_block_video, _truncate_clip, _lengthen_clip])
def test_a_video_that_cannot_be_made_is_reported_and_the_rest_goes_on(
    study: StudyFolder, break_it: Callable[[StudyFolder], None]
) -> None:
    break_it(study)
    told: list[RenderProgress] = []
    count = render(study, processes=1, on_progress=told.append)
    assert [failure.split(":")[0] for failure in count.failures] == [
        "videos/clips/mismatched/take_01.mp4"
    ]
    assert (count.left_out, count.made) == (2, 17)
    assert (told[-1].videos, told[-1].failed) == (20, 3)
    assert not any(
        clip.file.endswith("mismatched/take_01.mp4") for clip in read_stimuli(study.stimuli).clips
    )
    assert len(read_stimuli(study.stimuli).clips) == 7


def frames_of(folder: StudyFolder) -> dict[str, int]:
    return {path.name: path.stat().st_size for path in (folder.videos / ".frames").glob("*.mkv")}


def test_without_room_for_frames_the_same_pairs_come_out_and_no_frames_stay(
    study: StudyFolder, tmp_path: Path
) -> None:
    roomy = StudyFolder(tmp_path / "roomy")
    shutil.copytree(study.root, roomy.root)
    render(roomy, processes=1)
    most = 0

    def look(progress: RenderProgress) -> None:
        nonlocal most
        most = max(most, len(frames_of(study)))

    count = render(study, processes=1, frames_cache=0, on_progress=look)
    assert (count.made, count.failures) == (20, ())
    assert frames_of(study) == {}
    assert len(frames_of(roomy)) == 8
    assert most == 4
    for here, there in zip(videos_of(study), videos_of(roomy), strict=True):
        assert here.read_bytes() == there.read_bytes()

    # Frames that were let go are made again where a new pair needs them.
    pair = read_stimuli(study.stimuli).pairs[0]
    before = (study.root / pair.file).read_bytes()
    (study.root / pair.file).unlink()
    count = render(study, processes=1, frames_cache=0)
    assert (count.made, count.failures) == (3, ())
    assert (study.root / pair.file).read_bytes() == before


def test_a_disk_that_is_too_small_is_told_before_anything_is_rendered(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: Disk(10**9, 10**9 - 1000, 1000))
    with pytest.raises(InputError, match=r"may need .*B, and 1.0 kB are free.*--frames-cache"):
        render(study, processes=1)
    assert list(study.videos.iterdir()) == []


def test_what_a_killed_process_left_half_written_is_swept_away(study: StudyFolder) -> None:
    drafts = [
        study.videos / ".frames" / ".draft.mkv",
        study.videos / "pairs" / ".draft.mp4",
    ]
    for draft in drafts:
        draft.parent.mkdir(parents=True, exist_ok=True)
        draft.write_bytes(b"half")
    render(study, processes=1)
    assert not any(draft.exists() for draft in drafts)


def test_a_study_is_rendered_by_one_run_at_a_time(study: StudyFolder) -> None:
    tried: list[str] = []

    def render_again(progress: RenderProgress) -> None:
        if progress.videos == 0:
            with pytest.raises(InputError, match="rendered already") as refusal:
                render(study, processes=1)
            tried.append(str(refusal.value))

    render(study, processes=1, on_progress=render_again)
    assert len(tried) == 1


def test_speech_that_cannot_be_as_loud_as_the_others_is_told(study: StudyFolder) -> None:
    speech = read_audio(study.speech / "take.wav")
    samples = speech.samples.copy()
    samples[: speech.sample_rate] = 0
    write_wav(study.speech / "take.wav", Audio(samples, speech.sample_rate))
    notes = render(study, processes=1).notes
    assert notes == ("the speech of segment take_01: it is silent; left as it is",)
