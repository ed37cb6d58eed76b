"""The table of segments and conditions shows present, missing and bad material, and plays it."""

import json
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from motion.segment import write_segments
from studyapp.desk.job_kinds import RECORD
from studyapp.desk.jobs import no_other_job
from studyapp.desk.lab import Lab, LabStudy
from studyapp.desk.material_page import Material
from studyapp.study.folder import StudyFolder
from studyapp.study.media import ClipVideo, read_stimuli, write_stimuli
from tests.studyapp.desk.conftest import Joined, changes
from tests.studyapp.web.page_reader import PageReader
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.support.studies.takes import write_motion

TINY = "/research/studies/tiny/"
MATERIAL = f"{TINY}material"


@pytest.fixture
def folder(lab: Lab) -> StudyFolder:
    """Return the study, with one motion and one rendered clip as its only material."""
    folder = StudyFolder(lab.folder / "tiny")
    write_motion(folder.clip("rule_based", "take-0"), 2.0)
    write_motion(folder.clip("mismatched", "take-1"), 2.0)
    stimuli = read_stimuli(folder.stimuli)
    file = "videos/rule_based/take-0.mp4"
    (folder.root / file).parent.mkdir()
    shutil.copy(folder.root / stimuli.pairs[0].file, folder.root / file)
    clip = ClipVideo(segment="take-0", condition="rule_based", file=file, duration=2.0, key="k")
    write_stimuli(folder.stimuli, stimuli.model_copy(update={"clips": (clip,)}))
    return folder


def cells(page: PageReader) -> dict[tuple[str, str], str]:
    """Return the text of each cell of the table."""
    table = page.one("table.material")
    _, _, *conditions = [each.text for each in table.select("thead th")]
    table_cells = {}
    for row in table.select("tbody tr"):
        segment = row.select_one("th").text  # type: ignore[union-attr]
        for condition, cell in zip(conditions, row.select("td")[1:], strict=True):
            table_cells[segment, condition] = cell.text.split(" ")[0]
    return table_cells


def write_finding(folder: StudyFolder, where: str, what: str) -> None:
    path = folder.root / RECORD
    path.parent.mkdir(parents=True, exist_ok=True)
    finding = {"name": "x", "severity": "error", "where": where, "what": what, "remedy": "Do it"}
    path.write_text(json.dumps({"format": 1, "findings": [finding]}), "utf-8")


def test_the_table_shows_present_missing_and_bad_material(
    folder: StudyFolder, ada: ResearchBrowser
) -> None:
    write_finding(folder, "motion/mismatched/take-1.npz", "the archive is damaged")
    table_cells = cells(ada.get(MATERIAL))
    assert len(table_cells) == 12
    assert table_cells["take-0", "rule based"] == "video"
    assert table_cells["take-1", "mismatched"] == "bad"
    assert set(table_cells.values()) == {"video", "bad", "missing"}
    page = ada.get(f"{MATERIAL}/take-1")
    assert "The archive is damaged. Do it." in page.text
    os.utime(folder.root / RECORD, (1, 1))
    assert cells(ada.get(MATERIAL))["take-1", "mismatched"] == "motion"
    # A problem of the whole study is no clip's.
    write_finding(folder, "", "the consent text is missing")
    assert "bad" not in cells(ada.get(MATERIAL)).values()
    # A problem of a pair is shown for both sides, as far as they are there.
    pair = read_stimuli(folder.stimuli).pairs[0].file
    write_finding(folder, pair, f"{pair} has no sound")
    assert cells(ada.get(MATERIAL))["take-0", "mismatched"] == "missing"
    write_motion(folder.clip("mismatched", "take-0"), 2.0)
    write_finding(folder, pair, f"{pair} has no sound")
    table_cells = cells(ada.get(MATERIAL))
    assert table_cells["take-0", "rule based"] == table_cells["take-0", "mismatched"] == "bad"
    assert f"{pair} has no sound. Do it." in ada.get(f"{MATERIAL}/take-0").text
    shutil.rmtree(folder.speech)
    assert "there is no speech yet" in ada.get(MATERIAL).text.lower()
    ada.get(TINY)


def test_finished_videos_are_shown_as_they_are(finished_study: Callable[[str], Path]) -> None:
    rows = Material(StudyFolder(finished_study("rating"))).rows()
    assert rows
    assert {cell.state for _, row in rows for cell in row} == {"video"}


def test_a_viewer_plays_a_video_and_is_offered_no_removal(
    folder: StudyFolder, ada: ResearchBrowser, joined: Joined
) -> None:
    mary = joined("viewer")
    page = mary.get(f"{MATERIAL}/take-0")
    (video,) = page.soup.select("video")
    answer = mary.client.get(str(video["src"]), headers={"Range": "bytes=0-99"})
    assert (answer.status_code, len(answer.data)) == (206, 100)
    answer.close()
    assert not page.soup.select("form[action$=remove]")


def test_only_motion_that_is_there_is_offered_in_3d(
    folder: StudyFolder, ada: ResearchBrowser
) -> None:
    write_motion(folder.clip("broken", "take-0"), 2.0)
    row = ada.get(MATERIAL).soup.select("tbody th a")[0]
    assert row.text == "take-0"
    assert "Play rule based, broken" in ada.get(str(row["href"])).text
    still = ada.get(f"{MATERIAL}/take-3")
    assert not still.soup.select(".motion-viewer, script[src*=viewer]")
    assert "no motion to turn around" in still.text


@pytest.mark.usefixtures("folder")
def test_only_the_studys_own_clips_are_served(ada: ResearchBrowser) -> None:
    for where in ("no_such", "..", "take-3/motion/0", "take-0/none.mp4", "take-3/rule_based.mp4"):
        ada.get(f"{MATERIAL}/{where}", 404)


def test_a_file_is_deleted_after_confirmation(
    tiny: LabStudy, folder: StudyFolder, ada: ResearchBrowser
) -> None:
    path = folder.clip("mismatched", "take-1")
    write_finding(folder, "motion/mismatched/take-1.npz", "the archive is damaged")
    where, form = f"{MATERIAL}/take-1/remove", {"condition": "mismatched"}
    assert ada.post(where, **form).status_code == 409
    assert ada.post(where, condition="no_such", sure="on").status_code == 404
    assert path.is_file()
    assert ada.post(where, **form, sure="on").status_code == 303
    assert not path.exists()
    assert "damaged" not in ada.get(f"{MATERIAL}/take-1").text
    # Nor is the file that takes its place bad, though it was written before the check.
    write_motion(path, 2.0)
    os.utime(path, (1, 1))
    assert "damaged" not in ada.get(f"{MATERIAL}/take-1").text
    assert changes(tiny)[0] == ("Ada", "material removed", "motion/mismatched/take-1.npz")


def test_a_segment_is_removed_with_all_that_belongs_to_it(
    tiny: LabStudy, folder: StudyFolder, ada: ResearchBrowser
) -> None:
    write_motion(folder.clip("broken", "take-0"), 2.0)
    theirs = folder.videos / "theirs"
    theirs.mkdir()
    for name in ("take-0", "take-0@take-1", "take-1@take-0", "take-01", "take-0.1"):
        (theirs / f"{name}.mp4").touch()
    (other,) = (clip for clip in folder.root.glob("motion/*/*.npz") if clip.stem != "take-0")
    stimuli = read_stimuli(folder.stimuli)
    row = ada.get(MATERIAL).soup.select("tbody th a")[0]
    where = str(ada.get(str(row["href"])).soup.select("form[action$=remove]")[-1]["action"])
    assert ada.post(where).status_code == 409
    assert ada.post(where, sure="on").status_code == 303
    assert [segment.name for segment in folder.segments()] == ["take-1", "take-2", "take-3"]
    for video in (*stimuli.clips, *stimuli.pairs):
        assert (folder.root / video.file).exists() is (video.segment != "take-0"), video
    assert list(folder.root.glob("motion/*/*.npz")) == [other]
    assert {path.stem for path in theirs.iterdir()} == {"take-01", "take-0.1"}
    assert changes(tiny)[0] == ("Ada", "material removed", "segment take-0")
    # Speech remains for as long as a segment uses it, and one segment always does.
    for name in ("take-1", "take-2"):
        assert ada.post(f"{MATERIAL}/{name}/remove", sure="on").status_code == 303
    answer = ada.post(f"{MATERIAL}/take-3/remove", sure="on")
    assert (answer.status_code, "The last segment cannot be removed" in answer.text) == (409, True)
    assert (folder.speech / "take.wav").exists()


def test_what_participants_see_stays_and_what_came_by_mistake_goes(
    folder: StudyFolder, ada: ResearchBrowser, taken: LabStudy
) -> None:
    (folder.speech / "stray.wav").write_bytes((folder.speech / "take.wav").read_bytes())
    segments = folder.segments()
    write_segments(folder.speech, (*segments, replace(segments[0], name="stray", wav="stray.wav")))
    write_motion(folder.clip("rule_based", "stray"), 2.0)
    for condition in ("rule_based", ""):
        answer = ada.post(f"{MATERIAL}/take-0/remove", sure="on", condition=condition)
        assert (answer.status_code, "people have taken part" in answer.text.lower()) == (409, True)
    with no_other_job(folder.jobs):
        assert "another job" in ada.post(f"{MATERIAL}/stray/remove", sure="on").text.lower()
    assert ada.post(f"{MATERIAL}/stray/remove", sure="on").status_code == 303
    assert folder.segments() == segments
    assert not (folder.speech / "stray.wav").exists()
    assert not folder.clip("rule_based", "stray").exists()
    assert folder.clip("rule_based", "take-0").exists()
    assert taken.standing().state == "running"
