from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from benchmarks.learned_motion.following import JAW, Followed, Speech, follow, mean_followed
from motion.clip import ARKIT_COUNT, MotionClip
from motion.skeleton import JOINT_COUNT, joint_index
from tests.motion.random_clips import clip_of

FRAMES = 90
RATE = 15.0


def swinging(speed: NDArray[np.float64], jaw: NDArray[np.float64] | None = None) -> MotionClip:
    """Return a clip whose elbows turn as fast, in radians per second, as `speed` says."""
    poses = np.zeros((len(speed), JOINT_COUNT, 3))
    for side in ("left", "right"):
        poses[:, joint_index(f"{side}_elbow"), 1] = np.cumsum(speed) / RATE
    arkit = np.zeros((len(speed), ARKIT_COUNT))
    if jaw is not None:
        arkit[:, JAW] = jaw
    return clip_of(poses, frame_rate=RATE, arkit=arkit)


def curve(seed: int) -> NDArray[np.float64]:
    """Return a curve between 0 and 1 that rises and falls several times a second."""
    places = np.random.default_rng(seed).uniform(size=24)
    return np.interp(np.linspace(0, 23, FRAMES), np.arange(24), places)


def speech(seed: int) -> Speech:
    return Speech(
        wrist_speed=curve(seed),
        jaw_open=curve(seed + 100),
        onsets=np.arange(0.2, 6, 0.7),
        strokes=np.arange(0.5, 6, 0.9),
    )


def test_wrists_driven_by_the_process_follow_it_and_still_ones_do_not() -> None:
    spoken = speech(1)
    score = follow(swinging(spoken.wrist_speed, spoken.jaw_open), spoken)
    still = follow(swinging(np.zeros(FRAMES)), spoken)
    assert score.wrist_speed > 0.95
    assert score.jaw_open == pytest.approx(1, abs=1e-6)
    assert np.isnan([still.wrist_speed, still.jaw_open, still.beats]).all()


def test_hands_that_stop_at_the_strokes_of_speech_are_aligned() -> None:
    spoken = speech(1)
    moment = (np.arange(FRAMES) + 0.5) / RATE
    since = np.abs(moment[:, None] - spoken.strokes).min(axis=1)
    resting = swinging(np.minimum(since, 0.3))
    elsewhere = replace(spoken, strokes=spoken.strokes + 0.45)
    assert follow(resting, spoken).strokes > 0.4
    assert follow(resting, elsewhere).strokes < 0


def test_a_mean_skips_undefined_clips_and_resamples_by_text() -> None:
    values = {f"t{number}": float(number % 2) for number in range(20)} | {"still": math.nan}
    scores = {
        take: Followed(wrist_speed=value, jaw_open=0.0, beats=0.0, strokes=0.0)
        for take, value in values.items()
    }
    alone = mean_followed(scores, {take: take for take in values}, "wrist_speed")
    together = mean_followed(scores, {k: str(v) for k, v in values.items()}, "wrist_speed")
    assert alone.clips == 20
    assert alone.mean == pytest.approx(0.5)
    assert alone.low < 0.5 < alone.high
    assert together.high - together.low > 1.5 * (alone.high - alone.low)
