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


def test_the_demo_has_a_sentence_per_emotion_and_resumes(tmp_path: Path) -> None:
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
    report = Mock()
    monkeypatch.setattr("studyapp.cli.plan_command.rehearse_command.callback", Mock())
    for name in ("generate", "render", "check", "report"):
        monkeypatch.setattr(f"studyapp.cli.{name}_command.command.callback", report)
    for is_rehearsal in (True, False):
        run("demo", tiny_study)
        assert report.call_args.kwargs["rehearsal"] is is_rehearsal
        StudyFolder(tiny_study).responses.touch()
