from itertools import product
from pathlib import Path

import pytest
from bs4 import BeautifulSoup

from studyapp.stimuli.figures.contact_sheet import write_contact_sheet
from studyapp.study.folder import StudyFolder
from studyapp.study.media import ClipVideo, Stimuli, read_stimuli, write_stimuli
from tests.renderer.figures.small_videos import write_block_video
from tests.studyapp.conftest import OwnStudy
from tests.support.studies.finished_study import PROTOCOLS, SEGMENTS
from tests.support.studies.takes import write_motion
from tests.support.studies.tiny_study import SECONDS

CONDITIONS = ("rule_based", "mismatched", "broken")


@pytest.fixture
def study(tiny_study: Path) -> StudyFolder:
    """Return the tiny study with a clip of a swaying block for each segment and condition."""
    folder = StudyFolder(tiny_study)
    clips = []
    segments = [segment.name for segment in folder.segments()]
    for number, (segment, condition) in enumerate(product(segments, CONDITIONS)):
        file = f"videos/clips/{condition}/{segment}.mkv"
        write_block_video(folder.root / file, [40 + k % (3 + number) for k in range(60)])
        clips.append(
            ClipVideo(
                segment=segment, condition=condition, file=file, duration=SECONDS, key=f"{number}"
            )
        )
    pairs = read_stimuli(folder.stimuli).pairs
    write_stimuli(folder.stimuli, Stimuli(clips=tuple(clips), pairs=pairs))
    return folder


def kept_cells(study: StudyFolder) -> dict[Path, int]:
    cells = (study.videos / "sheet" / ".cells").glob("*.webp")
    return {path: path.stat().st_mtime_ns for path in cells}


def with_key(study: StudyFolder, *changed: ClipVideo) -> None:
    """Record that clips were rendered again."""
    stimuli = read_stimuli(study.stimuli)
    clips = [
        clip.model_copy(update={"key": f"{clip.key} anew"}) if clip in changed else clip
        for clip in stimuli.clips
    ]
    write_stimuli(study.stimuli, stimuli.model_copy(update={"clips": tuple(clips)}))


def test_the_sheet_shows_each_segment_in_each_condition_and_draws_only_what_changed(
    study: StudyFolder,
) -> None:
    steps: list[tuple[int, int]] = []
    page = write_contact_sheet(study, threads=2, on_done=lambda *step: steps.append(step))
    assert page == study.videos / "sheet" / "index.html"
    text, before = page.read_text(encoding="utf-8"), kept_cells(study)
    assert text.count("<img") == 12
    segments = [segment.name for segment in study.segments()]
    assert all(name in text for name in ("rule based", "mismatched", "broken", *segments))
    assert steps[-1] == (16, 16)
    first, second, third = read_stimuli(study.stimuli).clips[:3]
    assert f'href="../../{first.file}"' in text

    write_contact_sheet(study, threads=1)
    assert kept_cells(study) == before
    assert page.read_text(encoding="utf-8") == text

    write_block_video(study.root / first.file, [40] * 60)
    (study.root / second.file).unlink()
    (study.root / third.file).write_bytes(b"no video" * 30)
    with_key(study, first, third)
    text = write_contact_sheet(study, threads=1).read_text(encoding="utf-8")
    assert text.count("<img") == 10
    for remark in ("never moves", "there is no video", "the video cannot be read"):
        assert remark in text
    assert len(set(kept_cells(study)) - set(before)) == 1


def motion_links(page: Path) -> dict[str, str]:
    """Return the sheet's link for each segment with motion."""
    soup = BeautifulSoup(page.read_text("utf-8"), "html.parser")
    return {
        row.select("b")[0].text: str(link["href"])
        for row in soup.select("tbody th")
        for link in row.select("a")
    }


def test_motion_pages_are_rewritten_when_the_motion_changes(study: StudyFolder) -> None:
    motions = (("take-0", "rule_based"), ("take-0", "broken"), ("take-2", "broken"))
    for segment, condition in motions:
        write_motion(study.clip(condition, segment), SECONDS)
    page = write_contact_sheet(study, threads=1)
    before = motion_links(page)
    assert list(before) == ["take-0", "take-2"]
    turned = (page.parent / before["take-0"]).read_text("utf-8")
    assert "Play rule based, broken" in turned
    assert len(turned) < 100_000
    place = page.parent / "motion"
    beside = {"avatar.js", "three.min.js", "viewer.js", "viewer.css"}
    assert {path.name for path in place.iterdir() if path.suffix != ".html"} == beside

    stimuli = read_stimuli(study.stimuli)
    with_key(study, *(clip for clip in stimuli.clips if clip.segment == "take-2"))
    after = motion_links(write_contact_sheet(study, threads=1))

    assert after["take-0"] == before["take-0"]
    assert after["take-2"] != before["take-2"]
    assert {f"motion/{path.name}" for path in place.glob("*.html")} == set(after.values())


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_finished_videos_are_shown_with_their_roles(own_study: OwnStudy, protocol: str) -> None:
    folder = own_study(protocol)
    (folder.videos / "theirs" / "two.mp4").write_bytes(b"no video")

    text = write_contact_sheet(folder, threads=1).read_text(encoding="utf-8")

    shown = 4 if protocol == "pairwise" else 3
    assert text.count("<img") == 3 * shown - 1
    assert all(f"../../videos/ours/{name}.mp4" in text for name in SEGMENTS)
    assert ("reference" in text) == (protocol in ("pairwise", "ranking"))
    assert ("catch trials" in text) == (protocol == "pairwise")
