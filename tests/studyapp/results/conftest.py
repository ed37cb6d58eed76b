"""Studies that people have answered, each made once."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from analysis.report.figures import style
from benchmarks.rendering.sample_motion import gesturing_clip
from motion.audio import Audio, write_wav
from motion.formats.clip_npz import write_clip
from motion.segment import write_segments
from studyapp.database.tables import StudySession
from studyapp.session.ending import withdraw
from studyapp.study.folder import StudyFolder
from tests.support.studies.answered_study import answer_study
from tests.support.studies.stored import opened
from tests.support.studies.taking_part_steps import SetClock

Answered = Callable[..., StudyFolder]


@pytest.fixture(autouse=True)
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep to the database beside the study, and spare parts of fonts that nobody prints."""
    monkeypatch.delenv("DATABASE_URL", raising=False)
    monkeypatch.setitem(style.STYLE, "pdf.fonttype", 3)


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
        definition = root / "study.toml"
        definition.write_text(definition.read_text("utf-8") + more, "utf-8")
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


def leave(folder: StudyFolder, study_session: int) -> None:
    """Let a participant withdraw."""
    with opened(folder.responses) as database:
        with database.reading() as session:
            found = session.get_one(StudySession, study_session)
            token = found.token
        withdraw(database, token, SetClock())


LABELLED = '[conditions.ours]\nlabel = "Ours (full)"\n'


def with_motion(folder: StudyFolder, *conditions: str) -> StudyFolder:
    """Label a condition, and add speech, and motion of `conditions`, to a study of videos."""
    text = folder.definition.read_text("utf-8").replace("[conditions.ours]\n", LABELLED)
    folder.definition.write_text(text, "utf-8")
    segments = [
        replace(segment, wav=f"{segment.name}.wav", start=0.0, end=segment.duration)
        for segment in folder.segments_of(folder.study())
    ]
    folder.speech.mkdir()
    for segment in segments:
        tone = np.sin(np.arange(round(16_000 * segment.duration)) * 0.1).astype(np.float32) * 0.1
        write_wav(folder.speech / segment.wav, Audio(tone, 16_000))
        for condition in conditions:
            path = folder.clip(condition, segment.name)
            path.parent.mkdir(parents=True, exist_ok=True)
            write_clip(path, gesturing_clip(segment.duration, 30))
    write_segments(folder.speech, segments)
    return folder
