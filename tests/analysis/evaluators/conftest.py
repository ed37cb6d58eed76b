from pathlib import Path
from typing import Any

import pytest

from analysis.evaluators.clip_views import Channels
from analysis.evaluators.evaluator import Evaluator, Kind, load_evaluator
from analysis.evaluators.training import PRESETS, EvaluatorRequest, train_evaluator
from motion.body.face_landmarks import FaceLandmarks
from motion.body.model import read_body
from renderer.look import default_body
from tests.analysis.evaluators.swinging import sources
from tests.support.short_training import short_training, trained_shortly

__all__ = ["trained_shortly"]


def trained(folder: Path, kind: Kind, channels: Channels, *, steps: int, **options: Any) -> Path:
    """Train a tiny network for a few steps and return its file."""
    request = EvaluatorRequest(
        channels=channels, preset=PRESETS[kind]["tiny"], changes={"steps": steps}, **options
    )
    out = folder / f"{kind}-{channels}.safetensors"
    # A session's first file is made before `trained_shortly` holds; bytes are compared with it.
    with short_training():
        train_evaluator(request, sources(), out)
    return out


@pytest.fixture(scope="session")
def emotion_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return trained(tmp_path_factory.mktemp("emotion"), "emotion", "body", steps=15)


@pytest.fixture(scope="session")
def gesture_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return trained(tmp_path_factory.mktemp("gesture"), "motion", "gesture", steps=4)


@pytest.fixture(scope="session")
def face_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    landmarks = FaceLandmarks.of(read_body(default_body()))
    folder = tmp_path_factory.mktemp("face")
    return trained(folder, "face", "landmarks", steps=4, landmarks=landmarks)


@pytest.fixture(scope="session")
def both_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return trained(tmp_path_factory.mktemp("both"), "motion", "both", steps=2, frozen=("hands",))


@pytest.fixture
def emotion(emotion_file: Path) -> Evaluator:
    return load_evaluator(emotion_file)


@pytest.fixture
def gesture(gesture_file: Path) -> Evaluator:
    return load_evaluator(gesture_file)


@pytest.fixture(scope="session")
def reference(shared_data: Path) -> Path:
    """Return the folder of the published networks' outputs, or skip the test."""
    folder = shared_data.parent / "reference" / "evaluators"
    if not folder.is_dir():
        pytest.skip("the published networks' outputs (../shared/reference/evaluators) are not here")
    return folder
