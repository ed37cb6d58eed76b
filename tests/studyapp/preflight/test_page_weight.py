from __future__ import annotations

from pathlib import Path

import pytest

from motion.segment import Segment
from studyapp.preflight.material import Material
from studyapp.preflight.shown_video_checks import Weight, weight_findings, weight_of
from studyapp.study.design.planned_trial import PlannedTrial
from studyapp.study.design.stimulus import Stimulus
from studyapp.study.folder import StudyFolder
from tests.finished_study import write_finished_study, write_short_video


def trial(position: int, *videos: str, reference: str | None = None) -> PlannedTrial:
    return PlannedTrial(
        position=position,
        kind="main",
        segment=Segment(name="s", wav="s.wav", start=0.0, end=1.0, speaker="", emotion="neutral"),
        videos=tuple((Stimulus.own(video, "s"),) for video in videos),
        reference=None if reference is None else Stimulus.own(reference, "s"),
    )


SIZES = {(Stimulus.own(name, "s"),): size for name, size in (("a", 10), ("b", 20), ("c", 100))}


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
