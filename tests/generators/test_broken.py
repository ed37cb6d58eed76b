"""Broken: plainly so, within two seconds and throughout."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from generators.broken import Broken
from generators.interface import SpeechSegment, StudyClips
from motion.clip import MotionClip
from motion.rest_pose import REST_JOINTS
from motion.skeleton import forward_kinematics, joint_index

Speak = Callable[..., SpeechSegment]
ARM = [joint_index(f"{side}_{part}") for side in ("left", "right") for part in ("elbow", "wrist")]


def jerk(clip: MotionClip) -> np.ndarray:
    """Size of the third derivative of elbows and wrists, m/s^3, shape (T - 3, 4)."""
    joints, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    return np.linalg.norm(np.diff(joints[:, ARM], n=3, axis=0), axis=2) * clip.frame_rate**3


@pytest.fixture(params=range(4))
def pair(
    request: pytest.FixtureRequest, study: StudyClips, speak: Speak
) -> tuple[MotionClip, MotionClip]:
    whole = study.clip(study.segments[2].name)
    speech = speak(study.segments[2].name, len(whole) / 25)
    return whole, Broken().generate(speech, seed=request.param, frame_rate=25, source=study)


def test_every_second_is_far_jerkier_than_the_source(
    pair: tuple[MotionClip, MotionClip],
) -> None:
    whole, broken = pair
    for start in range(0, len(whole) - 25, 25):
        second = slice(start, start + 25)
        assert jerk(broken)[second].mean() > 8 * jerk(whole)[second].mean()


def test_every_two_seconds_hold_a_neck_or_wrist_twisted_too_far_and_an_elbow_bent_back(
    pair: tuple[MotionClip, MotionClip],
) -> None:
    _, broken = pair
    turns = np.degrees(np.linalg.norm(broken.poses, axis=2))
    twisting = [joint_index(name) for name in ("neck", "left_wrist", "right_wrist")]
    twisted = (turns[:, twisting] > 110).any(axis=1)
    # Elbows bend about -y on the left and +y on the right.
    backward = np.degrees(
        broken.poses[:, [joint_index("left_elbow"), joint_index("right_elbow")], 1]
    )
    bent_back = (backward * (1, -1) > 50).any(axis=1)
    for start in range(0, len(broken) - 50, 25):
        assert twisted[start : start + 50].any()
        assert bent_back[start : start + 50].any()


def test_the_body_freezes_at_times(study: StudyClips, speak: Speak) -> None:
    speech = speak(study.segments[2].name, 6.0)
    still = study.clip(study.segments[2].name)
    broken = Broken().generate(speech, seed=0, frame_rate=25, source=study)
    hip = joint_index("left_hip")
    stops = (np.abs(np.diff(broken.poses[:, hip], axis=0)).max(axis=1) == 0).sum()
    own_stops = (np.abs(np.diff(still.poses[:, hip], axis=0)).max(axis=1) == 0).sum()
    assert stops > own_stops + 10


def test_the_face_flickers(pair: tuple[MotionClip, MotionClip]) -> None:
    whole, broken = pair
    assert (
        np.abs(np.diff(broken.arkit, axis=0)).mean()
        > 5 * np.abs(np.diff(whole.arkit, axis=0)).mean()
    )
    assert (broken.arkit == 1).any(axis=1).mean() > 0.2


def test_a_source_without_a_face_stays_without(study: StudyClips, speak: Speak) -> None:
    name = study.segments[0].name

    class Faceless:
        segments = study.segments

        def clip(self, segment_name: str) -> MotionClip:
            return replace(study.clip(segment_name), arkit=None)

    clip = Broken().generate(speak(name, 4.0), seed=0, frame_rate=25, source=Faceless())
    assert clip.arkit is None
