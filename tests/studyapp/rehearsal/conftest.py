"""A small study, and the people who rehearse it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import av
import numpy as np
import pytest
import tomlkit

from motion.audio import Audio, write_wav
from motion.segment import Segment
from motion.segments_table import write_segments
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import PairVideo, Stimuli, write_stimuli
from studyapp.definition.study import Study
from studyapp.rehearsal.population import Population, default_population
from studyapp.services.served_study import shown_pairs

QUESTIONS = [
    {"name": "rhythm", "title": "Rhythm", "text": "Which fits the rhythm better?"},
    {"name": "emotion", "title": "Emotion", "text": "Which shows {emotion} better?"},
]
DURATION = 1.0


def definition(**changes: Any) -> dict[str, Any]:
    return {
        "name": "tiny",
        "title": "A tiny study",
        "reference": "rule_based",
        "conditions": {
            "rule_based": {"generator": "rule_based"},
            "mismatched": {"generator": "mismatched", "source": "rule_based"},
            "static": {"generator": "static"},
            "brought": {},
        },
        "questions": QUESTIONS,
        "page": {"consent": "I agree."},
        **changes,
    }


@pytest.fixture(scope="session")
def study() -> Study:
    return Study.model_validate(definition())


@pytest.fixture(scope="session")
def population(study: Study) -> Population:
    return default_population(study)


@pytest.fixture(scope="session")
def rendered(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study folder with two comparisons, three segments and a video for every pair."""
    folder = StudyFolder(tmp_path_factory.mktemp("rendered") / "tiny")
    folder.speech.mkdir(parents=True)
    content = definition(trials=3, practice=1, participants_per_comparison=3, catch={"trials": 1})
    del content["conditions"]["brought"]
    folder.definition.write_text(tomlkit.dumps(content), encoding="utf-8")
    write_wav(folder.speech / "speech.wav", Audio(np.zeros(16000, np.float32), 16000))
    segments = [
        Segment(
            name=f"s{index}", wav="speech.wav", start=0, end=DURATION, speaker="a", emotion="fear"
        )
        for index in range(3)
    ]
    write_segments(folder.speech, segments)
    video = folder.videos / "0.mp4"
    write_video(video)
    pairs = [
        PairVideo(
            segment=segment.name,
            left=left,
            right=right,
            file=str(
                shutil.copy(video, folder.videos / f"{index}-{number}.mp4").relative_to(folder.root)
            ),
            duration=DURATION,
            key=f"{index}-{number}",
        )
        for index, segment in enumerate(segments, start=1)
        for number, (left, right) in enumerate(shown_pairs(folder.study()))
    ]
    write_stimuli(folder.stimuli, Stimuli(pairs=tuple(pairs)))
    return folder.root


@pytest.fixture
def folder(rendered: Path, tmp_path: Path) -> StudyFolder:
    """A copy of the rendered study of one's own."""
    return StudyFolder(Path(shutil.copytree(rendered, tmp_path / "tiny")))


def write_video(path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(path, "w") as container:
        stream = container.add_stream("libx264", rate=10, options={"preset": "ultrafast"})
        stream.width = stream.height = 32
        stream.pix_fmt = "yuv420p"
        for shade in range(int(10 * DURATION)):
            picture = np.full((32, 32, 3), 20 * shade, np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())
