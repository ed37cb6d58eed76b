"""Studies that people have answered, each made once."""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from motion.segment import write_segments
from studyapp.study.folder import StudyFolder
from tests.support.studies.answered_study import answer_study
from tests.support.studies.redefining import redefine
from tests.support.studies.takes import write_motion, write_speech

Answered = Callable[..., StudyFolder]


@pytest.fixture(scope="module", autouse=True)
def figures_on_the_page_alone() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("analysis.report.page.FORMATS", {})
        yield


@pytest.fixture(scope="session")
def answered_once(
    finished_study: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[..., Path]:
    """Return a function that gives a study of a protocol, answered by some; tests take copies."""

    @cache
    def make(
        protocol: str, *, people: int = 2, stop_after: int | None = None, more: str = ""
    ) -> Path:
        root = tmp_path_factory.mktemp("answered") / protocol
        shutil.copytree(finished_study(protocol), root)
        redefine(root, added=more)
        if people:
            answer_study(root, people=people, stop_after=stop_after)
        return root

    return make


@pytest.fixture
def answered(answered_once: Callable[..., Path], tmp_path: Path) -> Answered:
    """Return a function that copies such a study for one test."""

    def copy(protocol: str, **answers: int) -> StudyFolder:
        return StudyFolder(
            shutil.copytree(answered_once(protocol, **answers), tmp_path / "study" / protocol)
        )

    return copy


def with_motion(folder: StudyFolder, *conditions: str) -> StudyFolder:
    """Label a condition, and add speech, and motion of `conditions`, to a study of videos."""
    ours = "[conditions.ours]\n"
    redefine(folder.root, (ours, f'{ours}label = "Ours (full)"\n'))
    segments = [
        replace(segment, wav=f"{segment.name}.wav", start=0.0, end=segment.duration)
        for segment in folder.segments_of(folder.study())
    ]
    folder.speech.mkdir()
    for segment in segments:
        write_speech(folder.speech / segment.wav, segment.duration)
        for condition in conditions:
            write_motion(folder.clip(condition, segment.name), segment.duration)
    write_segments(folder.speech, segments)
    return folder
