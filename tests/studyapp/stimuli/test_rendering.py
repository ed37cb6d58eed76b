import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip, write_clip
from renderer.jobs.making import run_jobs
from studyapp.stimuli.render_plan import RenderPlan
from studyapp.stimuli.render_record import RenderCount
from studyapp.stimuli.rendering import render
from studyapp.study.folder import StudyFolder
from studyapp.study.media import read_stimuli
from tests.support.encoded import pictures_of
from tests.support.studies.redefining import set_keys

pytestmark = pytest.mark.slow

FirstRun = tuple[StudyFolder, RenderCount, list[tuple[int, int, str]]]


@pytest.fixture(scope="module")
def first_run(generated: StudyFolder, tmp_path_factory: pytest.TempPathFactory) -> FirstRun:
    """The rendered study, its count and its progress."""
    root = tmp_path_factory.mktemp("rendered") / "study"
    folder = StudyFolder(Path(shutil.copytree(generated.root, root)))
    progress: list[tuple[int, int, str]] = []
    count = render(folder, processes=1, on_progress=lambda *state: progress.append(state))
    return folder, count, progress


def videos_of(folder: StudyFolder) -> Iterator[Path]:
    stimuli = read_stimuli(folder.stimuli)
    return (folder.root / record.file for record in (*stimuli.clips, *stimuli.pairs))


def test_every_clip_and_both_orders_of_every_pair_are_rendered(first_run: FirstRun) -> None:
    study, count, progress = first_run
    assert count.failures == ()
    assert count.notes == ()
    assert (count.made, count.kept) == (8 + 12, 0)
    assert progress[0] == (0, 20 * 10, "0 of 20 videos")
    assert progress[-1] == (20 * 10, 20 * 10, "20 of 20 videos")
    pairs = {pair.content: pair for pair in read_stimuli(study.stimuli).pairs}
    for content in study.study().contents(study.segments()):
        assert pictures_of(study.root / pairs[content].file).shape == (10, 96, 192, 3)


def test_frozen_channels_are_still_in_every_video(study: StudyFolder) -> None:
    path = study.clip("mismatched", "take_01")
    clip = read_clip(path)
    ahead = np.linspace(0, 1, len(clip), dtype=np.float32)[:, None] * np.ones(3, np.float32)
    walking = replace(clip, poses=np.zeros_like(clip.poses), trans=ahead)
    write_clip(path, replace(walking, expressions=None, arkit=None))
    assert "root" in study.study().freeze
    plan = RenderPlan.of(study)
    jobs = [plan.clip_job(each) for each in plan.clips if "mismatched/take_01" in each.file]

    run_jobs(jobs, processes=1)

    pictures = pictures_of(plan.frames("take_01", "mismatched"))
    assert (pictures == pictures[0]).all()


def test_only_videos_of_changed_clips_are_rendered_again(
    first_run: FirstRun, tmp_path: Path
) -> None:
    rendered = StudyFolder(Path(shutil.copytree(first_run[0].root, tmp_path / "rendered")))
    before = {path: path.stat().st_mtime_ns for path in videos_of(rendered)}
    # Left by a killed process.
    drafts = [rendered.videos / name for name in (".frames/.draft.mkv", "pairs/.draft.mp4")]
    for draft in drafts:
        draft.parent.mkdir(exist_ok=True)
        draft.write_bytes(b"half")
    assert render(rendered, processes=1).made == 0
    assert {path: path.stat().st_mtime_ns for path in videos_of(rendered)} == before
    assert not any(draft.exists() for draft in drafts)

    # Exchanged clips do not change the framing, which depends on all clips.
    one, two = (rendered.clip("mismatched", segment.name) for segment in rendered.segments())
    content = one.read_bytes(), two.read_bytes()
    two.write_bytes(content[0])
    one.write_bytes(content[1])
    count = render(rendered, processes=1)
    # In each segment the clip, its two pairs, and the reference that they show it with.
    assert (count.made, count.kept) == (2 * (1 + 2 + 1), 12)


def test_a_new_look_changes_every_video(study: StudyFolder) -> None:
    before = RenderPlan.of(study)
    for key, value in (("framing", "face"), ("view", "three_quarter"), ("background", "#2e3440")):
        set_keys(study.definition, {f"video.{key}": value})
        after = RenderPlan.of(study)
        for old, new in ((before.clips, after.clips), (before.pairs, after.pairs)):
            assert [video.file for video in old] == [video.file for video in new]
            assert not {video.key for video in old} & {video.key for video in new}
        before = after


def test_a_missing_clip_is_named_before_anything_is_rendered(study: StudyFolder) -> None:
    study.clip("mismatched", "take_02").unlink()
    with pytest.raises(InputError, match=r"1 of 8 .*'mismatched' for segment take_02.*generate"):
        render(study, processes=1)
    assert not study.videos.exists()


def test_failed_videos_and_hidden_faces_are_reported_and_the_others_made(
    study: StudyFolder,
) -> None:
    frozen = set(study.study().freeze) - {"face"}
    set_keys(study.definition, {"freeze": sorted(frozen)})
    for segment in study.segments():
        path = study.clip("ground_truth", segment.name)
        clip = read_clip(path)
        faces = np.full((len(clip), 100), 0.5)
        write_clip(path, replace(clip, expressions=faces, arkit=None))
    blocked = study.videos / "clips" / "mismatched" / "take_01.mp4"
    blocked.mkdir(parents=True)
    truncated = study.clip("mismatched", "take_02")
    truncated.write_bytes(truncated.read_bytes()[:2000])
    lengthened = study.clip("broken", "take_01")
    clip = read_clip(lengthened)
    write_clip(lengthened, replace(clip, frame_rate=clip.frame_rate / 2))
    progress: list[tuple[int, int, str]] = []
    count = render(study, processes=1, on_progress=lambda *state: progress.append(state))
    names = ("broken/take_01", "mismatched/take_01", "mismatched/take_02")
    broken = [f"videos/clips/{name}.mp4" for name in names]
    assert sorted(failure.split(":")[0] for failure in count.failures) == broken
    assert (count.left_out, count.made) == (6, 11)
    assert progress[-1][2] == "20 of 20 videos, 9 failed"
    made = [clip.file for clip in read_stimuli(study.stimuli).clips]
    assert len(made) == 5 and not {*broken} & {*made}
    (face,) = count.notes
    assert face.startswith("ground_truth: the clip's face is given as SMPL-X expression")


def frames_of(folder: StudyFolder) -> list[Path]:
    return list((folder.videos / ".frames").glob("*.mkv"))


def test_an_interrupted_run_resumes_with_the_frames_of_one_segment_and_makes_the_same_videos(
    study: StudyFolder, first_run: FirstRun
) -> None:
    whole, most = first_run[0], 0

    def look(*_state: object) -> None:
        nonlocal most
        most = max(most, len(frames_of(study)))

    def interrupt(_frames: int, _all_frames: int, videos: str) -> None:
        look()
        if videos == "10 of 20 videos":
            with pytest.raises(InputError, match="already being rendered"):
                render(study, processes=1)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        render(study, processes=1, on_progress=interrupt)
    count = render(study, processes=1, on_progress=look)
    assert count.kept >= 10
    assert (count.made + count.kept, count.failures) == (20, ())
    assert frames_of(study) == []
    assert most == 4
    for here, there in zip(videos_of(study), videos_of(whole), strict=True):
        assert here.read_bytes() == there.read_bytes()

    # Frames are made again when a new pair needs them.
    pair = read_stimuli(study.stimuli).pairs[0]
    before = (study.root / pair.file).read_bytes()
    (study.root / pair.file).unlink()
    count = render(study, processes=1)
    assert (count.made, count.failures) == (3, ())
    assert (study.root / pair.file).read_bytes() == before


def test_a_small_disk_is_refused_before_anything_is_rendered(
    study: StudyFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Enough for the videos, but not for the frames that pairs are composed of.
    free = SimpleNamespace(free=470_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda _folder: free)
    with pytest.raises(InputError, match=r"may need 50\d.* kB, but only 470.0 kB .*video.size"):
        render(study, processes=1)
    assert list(study.videos.iterdir()) == []
