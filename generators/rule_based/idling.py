"""What keeps resting hands alive: they drift, and go along with the voice a little."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.rule_based.gesture_plan import HANDS
from generators.rule_based.hand_pose import CHANNELS, CURLS, ELBOW_OUT, FLEXION, PLACE, PRONATION
from generators.rule_based.smooth_noise import smooth_noise

FloatArray = NDArray[np.float64]

_DRIFT: Final = 0.015
_DRIFT_TOGETHER: Final = 0.008
_TURN_DRIFT: Final = (1.5, 3.0, 2.5)
_CURL_DRIFT: Final = 0.07
_CURLS_CLASPED: Final = 0.5
_BEAT: Final = (0.0, -0.02, 0.04)
_BEAT_FLEXION: Final = -6.0
_BEAT_CURL: Final = -0.07


@dataclass(frozen=True, kw_only=True, eq=False)
class Idling:
    """What hands do beside their gestures, in the channels of `hand_pose`, each shape (T, 13).

    Attributes
    ----------
    own : mapping of str to ndarray
        What each hand does by itself.
    together : mapping of str to ndarray
        What both do as one, which leaves them where they are to each other.
    on_accents : ndarray
        A small beat on each accent while a hand rests.
    """

    own: Mapping[str, FloatArray]
    together: Mapping[str, FloatArray]
    on_accents: FloatArray

    def added(
        self, hand: str, course: FloatArray, *, alone: FloatArray, rests: FloatArray
    ) -> FloatArray:
        """Return the course of `hand` with what it does beside.

        Parameters
        ----------
        hand : str
        course : ndarray, shape (T, 13)
        alone : ndarray, shape (T,)
            1 where it moves by itself, 0 where it lies on the other.
        rests : ndarray, shape (T,)
            1 where it rests, 0 where it gestures.
        """
        free = np.repeat(alone[:, None], CHANNELS, axis=1)
        free[:, CURLS] = np.maximum(free[:, CURLS], _CURLS_CLASPED)
        beat = rests[:, None] * self.on_accents
        beat[:, PLACE.stop :] *= free[:, PLACE.stop :]
        return course + beat + free * self.own[hand] + (1 - free) * self.together[hand]


def idle(
    times: FloatArray, beats: FloatArray, restlessness: float, rng: np.random.Generator
) -> Idling:
    """Return what hands do beside their gestures.

    Parameters
    ----------
    times : ndarray, shape (T,)
        Seconds.
    beats : ndarray, shape (T,)
        1 at the strongest accent, 0 far from all.
    restlessness : float
        Speed of the drift against an unmoved speaker's.
    rng : numpy.random.Generator
    """
    slow, quick = 0.1 * restlessness, 1.0 * restlessness
    scale = np.zeros(CHANNELS)
    scale[PLACE] = _DRIFT
    scale[[ELBOW_OUT, PRONATION, FLEXION]] = _TURN_DRIFT
    scale[CURLS] = _CURL_DRIFT
    own = {hand: scale * smooth_noise(times, CHANNELS, slow, quick, rng) for hand in HANDS}
    shared = np.zeros((len(times), CHANNELS))
    shared[:, PLACE] = _DRIFT_TOGETHER * smooth_noise(times, 3, slow, quick, rng)
    mirrored = shared.copy()
    mirrored[:, 0] *= -1
    beat = np.zeros(CHANNELS)
    beat[PLACE], beat[FLEXION], beat[CURLS] = _BEAT, _BEAT_FLEXION, _BEAT_CURL
    return Idling(
        own=own,
        together=dict(zip(HANDS, (shared, mirrored), strict=True)),
        on_accents=beats[:, None] * beat,
    )
