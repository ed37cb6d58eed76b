from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from motion.segment import EMOTIONS
from studyapp.cli.demo_command import prepare_demo
from studyapp.study.folder import StudyFolder

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
