"""How much hands move, and rest: ``python -m benchmarks.hands_alive SPEECH.wav --recording FILE``.

Prints, for the rule-based generator with each emotion and for recordings, how fast finger joints
turn on average and in how many frames a wrist is at rest, all at `FRAME_RATE`. Without a speech, it
is made syllables.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.metrics.many_clips import made_speech
from generators.interface import SpeechSegment
from generators.rule_based.generator import RuleBased
from motion.audio import Audio, read_audio
from motion.clip import MotionClip
from motion.formats import read_motion
from motion.resample import resample
from motion.segment import EMOTIONS, Segment
from motion.skeleton import FINGERS, REST_JOINTS, forward_kinematics, joint_index

FRAME_RATE: Final = 15.0
RESTS: Final = 0.03
"""Metres per second below which a wrist is at rest."""

_MADE_SECONDS: Final = 30.0


@dataclass(frozen=True, kw_only=True)
class HandsAlive:
    """How much the hands of a clip move.

    Attributes
    ----------
    fingers : float
        Degrees per second by which a finger joint turns, on average over joints and frames.
    resting : float
        Share of frames in which a wrist moves slower than `RESTS`, over both wrists.
    """

    fingers: float
    resting: float


def hands_alive(clip: MotionClip) -> HandsAlive:
    """Return how much the hands of `clip`, of at least two frames, move."""
    clip = resample(clip, FRAME_RATE)
    turns = Rotation.from_rotvec(clip.poses[:, FINGERS].reshape(-1, 3))
    each = np.arange(len(turns)).reshape(len(clip), -1)
    steps = (turns[each[:-1].ravel()].inv() * turns[each[1:].ravel()]).magnitude()
    joints, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    wrists = joints[:, [joint_index("left_wrist"), joint_index("right_wrist")]]
    speed = np.linalg.norm(np.diff(wrists, axis=0), axis=2) * FRAME_RATE
    return HandsAlive(
        fingers=float(np.degrees(steps.mean()) * FRAME_RATE), resting=float((speed < RESTS).mean())
    )


def generated(audio: Audio, emotion: str, *, seed: int) -> MotionClip:
    """Return the rule-based generator's motion to a speech."""
    segment = Segment(
        name="speech", wav="a.wav", start=0, end=audio.duration, speaker="a", emotion=emotion
    )
    speech = SpeechSegment(segment=segment, audio=audio)
    return RuleBased().generate(speech, seed=seed, frame_rate=30)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each emotion and each recording."""
    parser = argparse.ArgumentParser(description="Measure how much hands move, and rest.")
    parser.add_argument("speech", type=Path, nargs="?", help="what is spoken")
    parser.add_argument("--recording", type=Path, action="append", default=[])
    parser.add_argument("--fps", type=float, help="true frame rate of the recordings")
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(arguments)
    for name, clip in _clips(asked):
        found = hands_alive(clip)
        print(f"{name}: fingers {found.fingers:.1f} °/s, wrists at rest {found.resting:.0%}")


def _clips(asked: argparse.Namespace) -> Iterator[tuple[str, MotionClip]]:
    if asked.speech is None:
        audio = made_speech(_MADE_SECONDS, np.random.default_rng(asked.seed))
    else:
        audio = read_audio(asked.speech)
    for emotion in EMOTIONS:
        yield emotion, generated(audio, emotion, seed=asked.seed)
    for path in asked.recording:
        yield path.name, read_motion(path, frame_rate=asked.fps)


if __name__ == "__main__":
    main()
