"""Posture and body motion of the corpus' speakers: angles over time, and BEAT's joints.

Every angle is a sum of its rest value, contributions of speaker, emotion and speech, and drift. The
strokes of a hand, each of the shape `stroke_shape`, add up over time. They push the angles of the
arm in the speaker's own direction.
"""

from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

import numpy as np
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from training.corpus.chance import Chance
from training.corpus.speakers import EMOTION_MOTION, CorpusSpeaker, read_table
from training.corpus.speech_curves import SpeechCurves, find_strokes, stroke_shape
from training.spaces.beat import UPPER_BODY_JOINTS

ARM_ANGLES: Final = ("lift", "spread", "turn", "bend", "roll", "wrist", "curl", "shrug")
"""Angles of an arm: upper arm raised forward and to the side, turned so that the forearm points
inward; elbow bent; forearm turned palm up; hand bent back; fingers bent; shoulder raised."""

_OUTWARD: Final = np.array([18.0, 12.0, -58.0, -8.0, 40.0, 10.0, -16.0, 0.0])
_UPWARD: Final = np.array([34.0, 8.0, -16.0, 46.0, 0.0, 16.0, -12.0, 3.0])
_FORWARD: Final = np.array([50.0, 4.0, -18.0, -40.0, 18.0, 12.0, -14.0, 0.0])
"""Amplitudes of a stroke of size 1 in the eight angles."""

_ARM_AT_REST: Final = np.array([11.0, 19.0, 27.0, 86.0, -35.0, 0.0, 12.0, 0.0])
_ARM_DRIFT: Final = np.array([6.0, 3.0, 7.0, 8.0, 8.0, 5.0, 5.0, 0.6])
_LOWEST: Final = np.array([-20.0, 4.0, -50.0, 8.0, -85.0, -50.0, -26.0, -18.0])
_HIGHEST: Final = np.array([80.0, 60.0, 50.0, 138.0, 65.0, 60.0, 80.0, 28.0])
"""Joint limits of the eight angles, approached smoothly over the last `_KNEE` degrees."""
_KNEE: Final = 12.0

_UPRIGHT: Final = 12.0
_CHIN: Final = -5.0
_TRUNK_DRIFT: Final = np.array([1.2, 2.0, 1.6])
_HEAD_DRIFT: Final = np.array([2.5, 5.0, 2.5])

_RISE_WITH_LOUDNESS: Final = 28.0
_REACH_WITH_LOUDNESS: Final = 14.0
_LEAN_WITH_LOUDNESS: Final = 4.0
_CHIN_UP_WITH_PITCH: Final = 10.0
_USUAL_LOUDNESS: Final = 0.5
_NOD_ATTACK, _NOD_RELEASE = 0.2, 0.32
_TWIST_OF_STROKE: Final = 3.0

_TRUNK_STREAM, _HEAD_STREAM, _ARM_STREAM = 1, 2, 3


@dataclass(frozen=True, kw_only=True, eq=False)
class BodyAngles:
    """Angles over time, in degrees.

    Attributes
    ----------
    trunk, head : ndarray, shape (T, 3)
        Forward (of the head: chin down), turned to the left, tilted to the left.
    arms : ndarray, shape (T, 2, 8)
        `ARM_ANGLES` of the right and of the left arm.
    """

    trunk: Floats
    head: Floats
    arms: Floats


def body_angles(
    curves: SpeechCurves,
    melody: Floats,
    emotion: str,
    speaker: CorpusSpeaker,
    chance: Chance,
    times: Floats,
) -> BodyAngles:
    """Return the body motion of a speaker.

    Parameters
    ----------
    curves : SpeechCurves
        The speech.
    melody : ndarray, shape (T,)
        Octaves above the voice's usual pitch, at `times`.
    emotion : str
        One of `motion.segment.EMOTIONS`.
    speaker : CorpusSpeaker
        The speaker.
    chance : Chance
        Random numbers, or expected values.
    times : ndarray, shape (T,)
        Seconds.
    """
    manner = EMOTION_MOTION[emotion]
    strokes = find_strokes(curves, manner.spacing)
    stroke_chance = chance.strokes(len(strokes.times))
    elapsed = times[:, None] - (strokes.times + stroke_chance.delays)
    shape = stroke_shape(elapsed, speaker.attack / manner.tempo, speaker.release / manner.tempo)
    hands = shape @ (stroke_chance.gains * strokes.sizes[:, None])  # (T, 2): leading, other
    right_left = hands if speaker.right_handed else hands[:, ::-1]
    loudness = curves.at(curves.slow_loudness, times) - _USUAL_LOUDNESS
    restless = speaker.restlessness * manner.restlessness

    nods = stroke_shape(elapsed, _NOD_ATTACK, _NOD_RELEASE) @ (
        strokes.sizes * stroke_chance.gains.max(1)
    )
    # The head follows the other half of the body a little.
    twist = _TWIST_OF_STROKE * (right_left[:, 1] - right_left[:, 0])
    trunk = chance.drift(times, 3, _TRUNK_STREAM) * _TRUNK_DRIFT * restless
    trunk[:, 0] += _UPRIGHT + speaker.lean + manner.lean + _LEAN_WITH_LOUDNESS * loudness
    trunk[:, 1] += twist
    head = chance.drift(times, 3, _HEAD_STREAM) * _HEAD_DRIFT * restless
    head[:, 0] += _CHIN + manner.head_down + speaker.nod * nods - _CHIN_UP_WITH_PITCH * melody
    head[:, 1] += speaker.head_turn + manner.head_turn + twist
    head[:, 2] += speaker.head_tilt + manner.head_tilt

    resting = _ARM_AT_REST + np.array(
        [
            manner.reach,
            speaker.elbow_width,
            -speaker.hand_width - manner.hand_width,
            speaker.hand_height + manner.hand_height,
            0.0,
            manner.wrist,
            manner.curl,
            manner.shrug,
        ]
    )
    direction = speaker.amplitude * manner.amplitude * stroke_direction(speaker)
    drift = chance.drift(times, 2 * len(ARM_ANGLES), _ARM_STREAM).reshape(len(times), 2, -1)
    arms = resting + right_left[:, :, None] * direction + drift * _ARM_DRIFT * restless
    arms[:, :, ARM_ANGLES.index("lift")] += (_REACH_WITH_LOUDNESS * loudness)[:, None]
    arms[:, :, ARM_ANGLES.index("bend")] += (_RISE_WITH_LOUDNESS * loudness)[:, None]
    return BodyAngles(trunk=trunk, head=head, arms=within_limits(arms))


def stroke_direction(speaker: CorpusSpeaker) -> Floats:
    """Return the effect of a stroke of size 1 on the eight angles of an arm."""
    direction: Floats = (
        speaker.outward * _OUTWARD + speaker.upward * _UPWARD + speaker.forward * _FORWARD
    )
    return direction


def within_limits(arms: Floats) -> Floats:
    """Return arm angles (..., 8) that approach the joints' limits smoothly and never pass them."""
    excess = np.maximum(arms - (_HIGHEST - _KNEE), 0)
    shortfall = np.maximum((_LOWEST + _KNEE) - arms, 0)
    limited: Floats = (
        arms
        - (excess - _KNEE * (1 - np.exp(-excess / _KNEE)))
        + (shortfall - _KNEE * (1 - np.exp(-shortfall / _KNEE)))
    )
    return limited


_COLLAR: Final = np.array([0.0, 10.0, -8.0])
"""Rotation of the left collar bone at rest: BEAT's shoulders are in front of the chest's middle."""

_HAND_AT_REST: Final = read_table("hand_at_rest.toml")

_BENT: Final = MappingProxyType({"1": 1.0, "2": 1.1, "3": 0.8})
"""Factors on a finger's curl at each of its joints."""

_NECK_SHARE: Final = 0.55
"""Share of the head's angles in the lower of the two joints of BEAT's prepared files."""


def joint_rotations(angles: BodyAngles) -> Floats:
    """Return the rotations of BEAT's 47 joints.

    Parameters
    ----------
    angles : BodyAngles
        T frames.

    Returns
    -------
    ndarray, shape (T, 141)
        Axis-angle in radians, in the order of `training.spaces.beat.UPPER_BODY_JOINTS`.
    """
    turns = {
        "Spine": _bent_forward(angles.trunk),
        "Neck": _bent_forward(_NECK_SHARE * angles.head),
        "Neck1": _bent_forward((1 - _NECK_SHARE) * angles.head),
    }
    for index, side in enumerate(("Right", "Left")):
        for joint, turn in _left_arm(angles.arms[:, index]).items():
            # A mirrored turn keeps its component about x and reverses the others.
            mirror = (1, -1, -1) if side == "Right" else (1, 1, 1)
            turns[f"{side}{joint}"] = turn * np.array(mirror)
    return np.concatenate([turns[name] for name in UPPER_BODY_JOINTS], axis=1)


def _bent_forward(angles: Floats) -> Floats:
    """Return the turn (T, 3) of trunk or neck: forward, to the left, tilted to the left."""
    return _turn(angles * np.array([1, 1, -1]))


def _turn(angles: Floats) -> Floats:
    """Return the rotation vectors of angles about x, y and z (T, 3) in degrees."""
    return np.asarray(Rotation.from_euler("XYZ", angles, degrees=True).as_rotvec())


def _left_arm(arm: Floats) -> dict[str, Floats]:
    """Return the turns (T, 3) of a left arm's joints; `arm` is (T, 8).

    With zero turns, the arm is level and the palm faces down. With the arm lowered, the elbow bends
    to the front and the palm faces inward.
    """
    lift, spread, turn, bend, roll, wrist, curl, shrug = (
        arm[:, index] for index in range(len(ARM_ANGLES))
    )
    zeros = np.zeros(len(arm))
    # About x, z and x in turn: forward, down from level, and about the upper arm itself.
    upper = Rotation.from_euler("XZX", np.stack([-lift, spread - 90, turn], axis=1), degrees=True)
    turns = {
        "Shoulder": _turn(_COLLAR + np.stack([zeros, zeros, shrug], axis=1)),
        "Arm": np.asarray(upper.as_rotvec()),
        "ForeArm": np.asarray(
            Rotation.from_euler("YX", np.stack([-bend, roll], axis=1), degrees=True).as_rotvec()
        ),
        "Hand": _turn(np.stack([zeros, zeros, wrist], axis=1)),
    }
    for joint, resting in _HAND_AT_REST.items():
        angles = np.tile(np.array(resting, np.float64), (len(arm), 1))
        if "Thumb" not in joint:
            angles[:, 2] -= _BENT.get(joint[-1], 0.0) * curl
        turns[joint] = _turn(angles)
    return turns
