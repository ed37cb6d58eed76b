"""What a study holds still is still in every protocol, from its motion to its instructions."""

from __future__ import annotations

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
from tests.support.studies.edited_study import edited
from tests.support.studies.finished_study import PROTOCOLS

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
    found = motion_findings(Material.read(folder, study))
    said = [f.what for f in found if f.severity != "note"]
    assert not [what for what in said for channel in FROZEN if what.startswith(channel)]
