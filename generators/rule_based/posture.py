"""Motion of trunk and head: posture, sway, breathing, following the hands, nods."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d

from generators.rule_based.body_pose import Trunk
from generators.rule_based.time_courses import on_accents, pulse, smooth_noise
from generators.rule_based.vocabulary import Channel, EmotionStyle
from motion.arrays import Floats
from motion.prosody import Prosody

_SOFT_KNEES: Final = -0.014
_SHIFT: Final = (0.011, 0.0, 0.005)
_PELVIS_SWAY: Final = (0.5, 1.6, 0.7)
_SPINE_SWAY: Final = (1.0, 1.6, 0.9)
_BREATH_BEND: Final = 0.7
_BREATH_LIFT: Final = 1.0
_FOLLOW_SMOOTHING: Final = 0.14
_TURN_WITH_REACH: Final = 9.0
_TILT_WITH_LIFT: Final = 4.0
_LEAN_WITH_REACH: Final = 5.0
_BEAT_OF_TRUNK: Final = 1.4
_HEAD_STAYS: Final = 0.85


def move_trunk(
    style: EmotionStyle,
    prosody: Prosody,
    hands: Mapping[str, Floats],
    times: Floats,
    rng: np.random.Generator,
) -> Trunk:
    """Return the motion of trunk and head.

    Parameters
    ----------
    style : EmotionStyle
    prosody : Prosody
        Prosody of the speech; the head nods on its accents.
    hands : mapping of str to ndarray, shape (T, 13)
        Channels of `vocabulary.HandPose`; the trunk turns and leans with the hands.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator
    """
    posture, life = style.posture, style.liveliness
    slow, quick = 0.05 * life.restlessness, 0.35 * life.restlessness
    drift = smooth_noise(times, 12, slow, quick, rng)
    breath = np.sin(2 * np.pi * life.breaths / 60 * times + rng.uniform(0, 2 * np.pi))
    beat = on_accents(prosody, times, rise=0.22, fall=0.4)
    follow = _trunk_following(hands, prosody.frame_rate)

    pelvis = drift[:, 0:3] * _PELVIS_SWAY * life.sway
    pelvis[:, 0] += posture.lean
    spine = drift[:, 3:6] * _SPINE_SWAY * life.sway + follow
    spine[:, 0] += posture.spine_bend - _BREATH_BEND * breath + _BEAT_OF_TRUNK * beat
    spine[:, 2] -= pelvis[:, 2]
    shift = drift[:, 6:9] * _SHIFT * life.sway
    shift[:, 1] += _SOFT_KNEES
    trembling = smooth_noise(times, 2, 5.0, 7.0, rng) * life.tremor
    return Trunk(
        pelvis=pelvis,
        spine=spine,
        head=_head(style, prosody, pelvis + spine, times, drift[:, 9:12], rng),
        shift=shift,
        shoulders_up=posture.shoulders_up + _BREATH_LIFT * breath + trembling[:, 0],
        shoulders_forward=posture.shoulders_forward + trembling[:, 1],
    )


def _head(
    style: EmotionStyle,
    prosody: Prosody,
    carried: Floats,
    times: Floats,
    drift: Floats,
    rng: np.random.Generator,
) -> Floats:
    """Return the head's turn on the trunk; it faces the viewer while the trunk moves."""
    posture, life = style.posture, style.liveliness
    head = -_HEAD_STAYS * carried
    head += (posture.head_down, posture.head_turn, posture.head_tilt)
    head += drift * (0.6, 1.2, 0.8) * life.head_drift
    head[:, 0] += life.nod * _nods(prosody, times)
    turns = rng.normal(0, 1, (len(prosody.accents), 2)) * (0.35, 0.22) * life.nod
    for accent, strength, turn in zip(prosody.accents, prosody.prominence, turns, strict=True):
        gesture = pulse(times, accent, 0.35, 0.6)[:, None]
        head[:, 1:] += gesture * strength * turn
    return head


def _nods(prosody: Prosody, times: Floats) -> Floats:
    """Return nods, slightly up, then down on each accent; 1 is the strongest's lowest point."""
    up = on_accents(prosody, times + 0.2, rise=0.2, fall=0.2)
    return on_accents(prosody, times, rise=0.17, fall=0.32) - 0.25 * up


def _trunk_following(hands: Mapping[str, Floats], frame_rate: float) -> Floats:
    """Return the spine's turn, shape (T, 3), that follows the hands as they reach and rise."""
    places = {side: hand[:, Channel.PLACE] for side, hand in hands.items()}
    reach = {side: place[:, 2] + 0.6 * place[:, 0] for side, place in places.items()}
    turn = -_TURN_WITH_REACH * (reach["left"] - reach["right"])
    tilt = _TILT_WITH_LIFT * (places["left"][:, 1] - places["right"][:, 1])
    lean = _LEAN_WITH_REACH * ((places["left"] + places["right"])[:, 2] / 2 - 0.4)
    turns = np.column_stack([lean, turn, tilt])
    smooth: Floats = gaussian_filter1d(
        turns, _FOLLOW_SMOOTHING * frame_rate, axis=0, mode="nearest"
    )
    return smooth
