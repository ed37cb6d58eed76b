from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip
from studyapp.definition.creation import new_study
from studyapp.definition.folder import StudyFolder
from studyapp.stages.recordings import Take

RATE = 16_000


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    made = StudyFolder(tmp_path / "study")
    new_study(made.definition, name="study", trials=2)
    return made


@pytest.fixture
def speech_file(tmp_path: Path) -> Callable[[float], Path]:
    def write(seconds: float, name: str = "take") -> Path:
        times = np.arange(round(seconds * RATE)) / RATE
        loudness = 0.5 + 0.5 * np.sin(2 * np.pi * 2.5 * times)
        samples = (0.3 * loudness * np.sin(2 * np.pi * 150 * times)).astype(np.float32)
        path = tmp_path / f"{name}.wav"
        write_wav(path, Audio(samples=samples, sample_rate=RATE))
        return path

    return write


@pytest.fixture
def motion_file(tmp_path: Path) -> Callable[..., Path]:
    def write(seconds: float, frame_rate: float = 30, name: str = "motion") -> Path:
        frames = round(seconds * frame_rate)
        poses = np.zeros((frames, 55, 3))
        poses[:, 16, 2] = np.linspace(0, -1, frames)
        path = tmp_path / f"{name}.npz"
        write_clip(
            path, MotionClip(poses=poses, trans=np.zeros((frames, 3)), frame_rate=frame_rate)
        )
        return path

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
