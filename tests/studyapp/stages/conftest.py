from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from studyapp.definition.creation import new_study
from studyapp.definition.folder import StudyFolder
from studyapp.stages.recordings import Take
from tests.studyapp.stages.takes import write_motion, write_speech


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    made = StudyFolder(tmp_path / "study")
    new_study(made.definition, name="study", trials=2)
    return made


@pytest.fixture
def speech_file(tmp_path: Path) -> Callable[..., Path]:
    def write(seconds: float, name: str = "take") -> Path:
        return write_speech(tmp_path / f"{name}.wav", seconds)

    return write


@pytest.fixture
def motion_file(tmp_path: Path) -> Callable[..., Path]:
    def write(seconds: float, frame_rate: float = 30, name: str = "motion") -> Path:
        return write_motion(tmp_path / f"{name}.npz", seconds, frame_rate)

    return write


@pytest.fixture
def take(speech_file: Callable[..., Path], motion_file: Callable[..., Path]) -> Callable[..., Take]:
    def make(
        *, speech: float = 6.0, motion: float = 6.0, segment: float | None = 2.0, name: str = "take"
    ) -> Take:
        return Take(
            motion=motion_file(motion),
            speech=speech_file(speech, name),
            frame_rate=None,
            segment_seconds=segment,
            condition="ground_truth",
            speaker="scott",
            emotion="neutral",
        )

    return make
