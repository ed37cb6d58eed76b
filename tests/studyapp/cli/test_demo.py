from __future__ import annotations

import shutil
from pathlib import Path
from unittest.mock import Mock

import pytest

from motion.segment import EMOTIONS
from studyapp.cli.demo_command import prepare_demo
from studyapp.study.folder import StudyFolder
from tests.support.command_line import run

pytestmark = pytest.mark.skipif(
    shutil.which("espeak-ng") is None, reason="espeak-ng, which speaks the sentences, is not here"
)


def test_the_demo_has_a_sentence_per_emotion_and_resumes(
    tmp_path: Path,
) -> None:
    folder = StudyFolder(tmp_path / "demo-study")
    assert prepare_demo(folder)
    segments = folder.segments()
    assert sorted(segment.emotion for segment in segments) == sorted(EMOTIONS)
    assert all(segment.duration >= 4 and segment.transcript for segment in segments)
    before = {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")}
    assert not prepare_demo(folder)
    assert {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")} == before

    (folder.speech / "segments.csv").unlink()
    assert prepare_demo(folder)
    assert folder.segments() == segments


def test_the_demo_reports_people_who_took_part_in_its_folder(
    tiny_study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ran = {name: Mock() for name in ("generate", "render", "check", "report")}
    for name, callback in ran.items():
        monkeypatch.setattr(f"studyapp.cli.{name}_command.command.callback", callback)
    monkeypatch.setattr("studyapp.cli.plan_command.rehearse_command.callback", Mock())
    run("demo", tiny_study)
    StudyFolder(tiny_study).responses.touch()
    run("demo", tiny_study)
    asked = [
        (call.kwargs["rehearsal"], call.kwargs["with_motion"])
        for call in ran["report"].call_args_list
    ]
    assert asked == [(True, True), (False, True)]
