"""What a study holds still is still in every protocol, from its motion to its instructions."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from motion.clip import moving_channels
from studyapp.preflight.material import Material
from studyapp.preflight.motion_checks import motion_findings
from studyapp.stimuli.generation import generate
from studyapp.stimuli.recordings import Take, import_take
from studyapp.stimuli.shown_motion import read_motion_shown
from studyapp.study.folder import StudyFolder
from studyapp.study.study_file import new_study
from studyapp.web.app import create_app
from studyapp.web.running import running
from tests.edited_study import edited
from tests.finished_study import PROTOCOLS, write_finished_study, write_short_video
from tests.studyapp.taking_part_steps import SetClock
from tests.studyapp.web.visitor import Visitor

FROZEN = ("face", "lower_body", "root")


@pytest.mark.parametrize("template", PROTOCOLS)
def test_no_frozen_channel_moves_in_any_motion_shown(
    tmp_path: Path, take: Callable[..., Take], template: str
) -> None:
    folder = StudyFolder(tmp_path / "study")
    new_study(folder.definition, template=template, name="study")
    with edited(folder.definition) as document:
        document["freeze"] = FROZEN
    import_take(folder, take(speech=4.0, motion=4.0, segment=2.0))
    generate(folder)
    study = folder.study()

    shown = read_motion_shown(folder, study, tuple(folder.segments()))

    assert shown
    assert not any(moving_channels(clip) & {*FROZEN} for clip in shown.values())
    assert any("hands" in moving_channels(clip) for clip in shown.values())
    found = motion_findings(Material.of(folder, study))
    said = [f.what for f in found if f.severity != "note"]
    assert not [what for what in said for channel in FROZEN if what.startswith(channel)]


def test_amuses_template_compares_gestures_of_a_still_face(tmp_path: Path) -> None:
    study = new_study(tmp_path / "study.toml", template="pairwise", name="study")

    assert study.freeze == FROZEN
    assert study.video.framing == "upper_body"
    assert all("gestures" in question.text for question in study.questions)
    assert "{emotion}" in study.questions[1].text


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_instructions_of_every_protocol_say_what_is_held_still(
    tmp_path: Path, protocol: str
) -> None:
    write_short_video(tmp_path / "short.mp4")
    write_finished_study(tmp_path, protocol, tmp_path / "short.mp4")
    definition = tmp_path / "study.toml"
    definition.write_text('freeze = ["face", "root"]\n' + definition.read_text())

    app = create_app(tmp_path)
    text = re.sub(r"\s+", " ", Visitor(app, SetClock()).enrol().page().text)
    with app.app_context():
        running().database.close()

    assert "Kept still on purpose in every video: the face and whole-body movement" in text
