"""Hands move as much, and rest as seldom, as recorded ones (BEAT: 13 to 24 °/s, 0 to 23%)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from generators.interface import SpeechSegment
from generators.rule_based.generator import RuleBased
from motion.audio import read_audio
from motion.clip import MotionClip
from motion.resample import resample
from motion.segment import Segment
from motion.skeleton import FINGERS, REST_JOINTS, forward_kinematics, joint_index

FRAME_RATE = 15.0
RESTS = 0.03
"""Metres per second below which a wrist is at rest."""


def fingers_and_rests(clip: MotionClip) -> tuple[float, float]:
    """Return how fast a finger joint turns, in degrees per second, and how often a wrist rests."""
    clip = resample(clip, FRAME_RATE)
    turns = Rotation.from_rotvec(clip.poses[:, FINGERS].reshape(-1, 3))
    each = np.arange(len(turns)).reshape(len(clip), -1)
    steps = (turns[each[:-1].ravel()].inv() * turns[each[1:].ravel()]).magnitude()
    joints, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    wrists = joints[:, [joint_index("left_wrist"), joint_index("right_wrist")]]
    speed = np.linalg.norm(np.diff(wrists, axis=0), axis=2) * FRAME_RATE
    return float(np.degrees(steps.mean()) * FRAME_RATE), float((speed < RESTS).mean())


@pytest.mark.parametrize("seed", [1, 2])
def test_neutral_hands_move_and_rest_like_recorded_ones(shared_data: Path, seed: int) -> None:
    audio = read_audio(shared_data / "2_scott_0_103_103.wav").cut(0, 30)
    segment = Segment(name="a", wav="a.wav", start=0, end=30, speaker="a", emotion="neutral")
    speech = SpeechSegment(segment=segment, audio=audio)
    fingers, resting = fingers_and_rests(RuleBased().generate(speech, seed=seed, frame_rate=30))
    assert 13 < fingers < 24
    assert resting < 0.23
