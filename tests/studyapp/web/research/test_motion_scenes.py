"""Researchers view a trial's motion in 3D, and learn nothing beyond the page before."""

import json
from pathlib import Path
from typing import Any

import pytest
from flask import Flask

from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.web.research.motion_scenes import scenes_of_trial
from tests.studyapp.web.research.conftest import LogIn
from tests.studyapp.web.research.research_browser import ResearchBrowser
from tests.studyapp.web.visitor import Visitor
from tests.support.studies.takes import write_motion
from tests.support.studies.taking_part_steps import SetClock

CONDITIONS = ("rule_based", "mismatched", "broken")
SESSION = "/research/study-sessions/1/1/motion"
PREVIEW = "/research/preview/0/1/1"


@pytest.fixture
def viewer(app: Flask, log_in: LogIn, clock: SetClock, tiny_study: Path) -> ResearchBrowser:
    """Return the browser of somebody who may only watch a study that a participant has begun."""
    for condition in CONDITIONS:
        for number in range(4):
            write_motion(StudyFolder(tiny_study).clip(condition, f"take-{number}"), 2.0)
    Visitor(app, clock).enrol().begin().page()
    return log_in("viewer")


def scene(browser: ResearchBrowser, page: str) -> dict[str, Any]:
    """Return the data for a page's viewer."""
    answer = browser.client.get(browser.get(page).value(".motion-viewer", "data-scene"))
    assert answer.mimetype == "application/json"
    packed: dict[str, Any] = json.loads(answer.data)
    return packed


def test_a_participants_trial_is_shown_in_3d_without_its_conditions(
    viewer: ResearchBrowser,
) -> None:
    packed = scene(viewer, SESSION)
    assert [clip["name"] for clip in packed["clips"]] == ["A", "B"]
    assert packed["speech"].startswith("data:")
    page_and_scene = viewer.get(SESSION).text + json.dumps(packed | {"speech": "", "clips": []})
    assert [name for name in CONDITIONS if name in page_and_scene] == []


def test_a_previewed_trial_names_its_conditions_and_missing_motion(
    viewer: ResearchBrowser, tiny_study: Path
) -> None:
    def remove(condition: str) -> None:
        for number in range(4):
            StudyFolder(tiny_study).clip(condition, f"take-{number}").unlink()

    assert f"{PREVIEW}/motion" in viewer.get(f"{PREVIEW}/").text
    remove("mismatched")
    packed = scene(viewer, f"{PREVIEW}/motion")
    (name,) = (clip["name"] for clip in packed["clips"])
    (note,) = packed["notes"]
    assert {name[:3], note[:3]} == {"A: ", "B: "}
    assert (name[3:], note[3:]) == ("rule based", "mismatched: there is no motion file.")
    remove("rule_based")
    assert scene(viewer, SESSION) == {
        "problem": "There is no motion to play. A: there is no motion file. "
        "B: there is no motion file."
    }


def test_only_trials_and_cacheable_viewer_files_are_served(viewer: ResearchBrowser) -> None:
    for address in (
        f"{SESSION}/1",
        "/research/study-sessions/1/7/motion",
        "/research/study-sessions/1/7/motion/0",
        f"{PREVIEW}7/motion",
        f"{PREVIEW}/motion/1",
        "/research/viewer/page.py",
        "/research/viewer/avatars/nobody",
    ):
        assert viewer.client.get(address).status_code == 404, address
    for name in ("three.min.js", "viewer.js", "viewer.css", "avatars/alex"):
        answer = viewer.client.get(f"/research/viewer/{name}", buffered=True)
        assert answer.status_code == 200
        assert "max-age=300" in answer.headers["Cache-Control"]


def content(condition: str, speech: str | None = "s") -> Content:
    return (Stimulus(condition=condition, segment="s", speech=speech),)


def test_clips_with_the_same_speech_play_side_by_side_if_they_fit() -> None:
    def clips(players: dict[int, Content]) -> list[tuple[str | None, str]]:
        scenes = scenes_of_trial(players, lambda letter, _: letter[0])
        return [(scene.speech, "".join(scene.labels)) for scene in scenes]

    other = {0: content("real"), 1: content("ours"), 2: content("ours", "other")}
    assert clips(other) == [("s", "RA"), ("other", "B")]
    assert clips({1: content("ours", None), 2: content("real", None)}) == [(None, "AB")]
    many = {number: content("ours") for number in range(1, 9)}
    assert clips(many) == [("s", "ABCDEF"), ("s", "GH")]
