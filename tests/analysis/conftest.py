import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.skeleton import JOINT_COUNT, joint_index
from tests.motion.random_clips import clip_of


@pytest.fixture(scope="session")
def closed_form(shared_data: Path) -> Mapping[str, Any]:
    """Return scores whose values follow from formulas, or skip the test."""
    path = shared_data.parent / "reference" / "stats" / "metrics_closed_form.json"
    if not path.is_file():
        pytest.skip("the closed-form scores (../shared/reference/stats) are not here")
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


@pytest.fixture
def waving() -> Callable[..., MotionClip]:
    """Return a maker of clips whose arms swing at a given rate."""

    def make(
        *,
        frequency: float = 1.0,
        seconds: float = 4.0,
        frame_rate: float = 30.0,
        amplitude: float = 0.6,
        drift: float = 0.0,
    ) -> MotionClip:
        frames = round(seconds * frame_rate)
        time = np.arange(frames) / frame_rate
        poses = np.zeros((frames, JOINT_COUNT, 3))
        swing = amplitude * np.sin(2 * np.pi * frequency * time)
        for joint in ("left_shoulder", "right_shoulder"):
            poses[:, joint_index(joint), 2] = swing
        trans = np.outer(drift * time, [1.0, 0.0, 0.0])
        return clip_of(poses, trans, frame_rate)

    return make
