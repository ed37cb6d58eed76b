from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.formats.bvh import read_bvh
from training.corpus.measuring import BEAT, FRAME_RATE, paces
from training.corpus.motion_curves import wrist_positions
from training.spaces.beat import body_values


def test_speed_and_acceleration_are_those_of_the_wrists() -> None:
    seconds = np.arange(31) / FRAME_RATE
    wrists = np.zeros((31, 2, 3))
    wrists[:, 0, 0] = 0.5 * seconds
    wrists[:, 1, 1] = seconds**2
    speed, acceleration = paces([wrists])
    assert speed.mean == pytest.approx((0.5 + 2.0) / 2, rel=0.02)
    assert acceleration.high == pytest.approx(2.0, rel=1e-6)
    assert acceleration.median < 2.0


def test_beats_pace_is_that_of_its_recording(shared_data: Path) -> None:
    motion = read_bvh(shared_data / "2_scott_0_1_1.bvh", frame_rate=FRAME_RATE)
    for found, stated in zip(paces([wrist_positions(body_values(motion))]), BEAT, strict=True):
        assert found.quantity == stated.quantity
        for name in ("mean", "median", "high"):
            assert getattr(found, name) == pytest.approx(getattr(stated, name), rel=0.02)
