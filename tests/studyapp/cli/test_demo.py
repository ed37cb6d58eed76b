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


def test_the_demo_speaks_one_sentence_of_four_seconds_or_more_per_emotion(tmp_path: Path) -> None:
    folder = StudyFolder(tmp_path / "demo-study")
    assert prepare_demo(folder)
    segments = folder.segments()
    assert sorted(segment.emotion for segment in segments) == sorted(EMOTIONS)
    assert all(segment.duration >= 4 for segment in segments)
    assert all(segment.transcript for segment in segments)


def test_the_demo_compares_three_conditions_without_a_recording(tmp_path: Path) -> None:
    folder = StudyFolder(tmp_path / "demo-study")
    prepare_demo(folder)
    study = folder.study()
    assert list(study.conditions) == ["rule_based", "mismatched", "static"]
    assert not study.has_recording
    assert (study.catch_against, study.catch.condition) == ("rule_based", "broken")
    assert study.participants_per_comparison == 25


def test_a_demo_that_is_there_is_kept(tmp_path: Path) -> None:
    folder = StudyFolder(tmp_path / "demo-study")
    prepare_demo(folder)
    before = {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")}
    assert not prepare_demo(folder)
    assert {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")} == before


def test_a_demo_interrupted_before_its_speech_was_whole_goes_on(tmp_path: Path) -> None:
    folder = StudyFolder(tmp_path / "demo-study")
    prepare_demo(folder)
    (folder.speech / "segments.csv").unlink()
    assert prepare_demo(folder)
    assert len(folder.segments()) == 8
