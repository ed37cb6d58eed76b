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


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> StudyFolder:
    folder = StudyFolder(tmp_path_factory.mktemp("demo") / "demo-study")
    assert prepare_demo(folder)
    return folder


def test_the_demo_speaks_one_sentence_of_four_seconds_or_more_per_emotion(
    demo: StudyFolder,
) -> None:
    segments = demo.segments()
    assert sorted(segment.emotion for segment in segments) == sorted(EMOTIONS)
    assert all(segment.duration >= 4 and segment.transcript for segment in segments)


def test_an_existing_demo_is_kept_and_an_interrupted_one_continues(
    demo: StudyFolder, tmp_path: Path
) -> None:
    folder = StudyFolder(Path(shutil.copytree(demo.root, tmp_path / "demo-study")))
    before = {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")}
    assert not prepare_demo(folder)
    assert {path: path.stat().st_mtime_ns for path in folder.root.rglob("*")} == before

    (folder.speech / "segments.csv").unlink()
    assert prepare_demo(folder)
    assert len(folder.segments()) == 8
