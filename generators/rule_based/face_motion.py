"""The face: emotional expression, brows on accents, blinks, gaze and the speaking mouth."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import ShortTimeFFT

from generators.rule_based.time_courses import (
    Movement,
    follow,
    minimum_jerk,
    on_accents,
    smooth_noise,
)
from generators.rule_based.vocabulary import EmotionStyle
from motion.arrays import Floats
from motion.audio import Audio
from motion.clip import ARKIT_NAMES
from motion.prosody import Prosody

_BROW_LEAD: Final = 0.06
_WAVERING: Final = 0.12
_QUIETED_BY_SPEECH: Final = 0.3
_LIP_SHAPES: Final = ("mouthSmile", "mouthFrown", "mouthPress", "mouthShrug", "mouthDimple")

_FIRST_FORMANT_OPEN: Final = (450.0, 1100.0)
_SECOND_FORMANT_FRONT: Final = (1600.0, 2800.0)
_VOICE: Final = (80.0, 2800.0)
_HISS: Final = (3500.0, 7500.0)
_WINDOW: Final = 0.025
_HOP: Final = 0.01
_LIP_INERTIA: Final = 0.03
_SPEECH_ENERGY: Final = 0.3
_JAW: Final = 0.42


def move_face(
    style: EmotionStyle,
    audio: Audio,
    prosody: Prosody,
    head_in_world: Floats,
    times: Floats,
    rng: np.random.Generator,
) -> Floats:
    """Return the face's movement.

    Parameters
    ----------
    style : EmotionStyle
    audio, prosody : Audio, Prosody
        The speech.
    head_in_world : ndarray, shape (T, 3)
        Turn of the head in degrees; the eyes compensate for it.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (T, 52)
        ARKit weights in [0, 1].
    """
    arkit = np.zeros((len(times), len(ARKIT_NAMES)))
    mouth = speaking_mouth(audio, prosody, times, style.face.mouth_opening)
    wavering = 1 + _WAVERING * smooth_noise(times, 1, 0.1, 0.7, rng)[:, 0]
    talking = 1 - _QUIETED_BY_SPEECH * np.clip(mouth["jawOpen"] / 0.3, 0, 1)
    for name, weight in style.face.steady.items():
        steady = weight * wavering * (talking if name.startswith(_LIP_SHAPES) else 1.0)
        _add_weights(arkit, name, steady)
    # Brows slightly lead the voice (Flecha-Garcia 2010).
    accents = on_accents(prosody, times, rise=0.18, fall=0.45, lead=_BROW_LEAD)
    for name, weight in style.face.on_accent.items():
        _add_weights(arkit, name, weight * accents)
    for name, course in mouth.items():
        _add_weights(arkit, name, course)
    for name, course in gaze(head_in_world, style.liveliness.looks_away, times, rng).items():
        _add_weights(arkit, name, course)
    lid_closure = blinks(style.liveliness.blinks, times, rng)
    for name in _sides("eyeBlink"):
        column = arkit[:, ARKIT_NAMES.index(name)]
        column[:] = np.maximum(column, lid_closure)
    for name in _sides("eyeWide"):
        arkit[:, ARKIT_NAMES.index(name)] *= 1 - lid_closure
    return np.asarray(np.clip(arkit, 0, 1))


def _sides(name: str) -> tuple[str, ...]:
    """Return the ARKit actions of `name`: the action itself, or its left and right ones."""
    return (name,) if name in ARKIT_NAMES else (f"{name}Left", f"{name}Right")


def _add_weights(arkit: Floats, name: str, course: Floats) -> None:
    for action in _sides(name):
        arkit[:, ARKIT_NAMES.index(action)] += course


_SIDEWAYS: Final = 32.0
_UP_AND_DOWN: Final = 25.0
_SACCADE: Final = 0.07
_FIXATION: Final = (0.5, 2.2)
_ON_VIEWER: Final = 0.65
_CLOSING: Final = 0.09
_OPENING: Final = 0.16


def gaze(
    head_in_world: Floats, looks_away: float, times: Floats, rng: np.random.Generator
) -> dict[str, Floats]:
    """Return the weights of the eyes' actions, each of shape (T,).

    The eyes rest on the viewer or on something nearby, jump between the two (saccades), and
    compensate for the head's turning (the vestibulo-ocular reflex).

    Parameters
    ----------
    head_in_world : ndarray, shape (T, 3)
        Turn of the head in degrees: forward, to its left, to its right shoulder.
    looks_away : float
        Root mean square of the angles between the viewer and other targets, in degrees.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator
    """
    jumps: list[Movement] = []
    moment = rng.uniform(*_FIXATION)
    while moment < times[-1]:
        off_viewer = rng.normal(0, looks_away, 2) * (1.0, 0.5)
        target = np.zeros(2) if rng.random() < _ON_VIEWER else off_viewer
        jumps.append(Movement(start=moment, end=moment + _SACCADE, target=target))
        moment += rng.uniform(*_FIXATION)
    gaze_angles = follow(np.zeros(2), jumps, times)
    left = gaze_angles[:, 0] - head_in_world[:, 1]
    down = gaze_angles[:, 1] - head_in_world[:, 0]
    to_left, to_right = np.maximum(left, 0) / _SIDEWAYS, np.maximum(-left, 0) / _SIDEWAYS
    return {
        "eyeLookOutLeft": to_left,
        "eyeLookInRight": to_left,
        "eyeLookInLeft": to_right,
        "eyeLookOutRight": to_right,
        "eyeLookDown": np.maximum(down, 0) / _UP_AND_DOWN,
        "eyeLookUp": np.maximum(-down, 0) / _UP_AND_DOWN,
    }


def blinks(per_minute: float, times: Floats, rng: np.random.Generator) -> Floats:
    """Return the closure of the lids at each time, shape (T,), in [0, 1].

    Parameters
    ----------
    per_minute : float
        Average number of blinks per minute.
    times : ndarray, shape (T,)
        Seconds.
    rng : numpy.random.Generator
    """
    lid_closure = np.zeros(len(times))
    # Gamma-distributed intervals of shape 3, not a Poisson process: blinks are not too close.
    average = 60 / per_minute
    moment = rng.uniform(0.2, average)
    while moment < times[-1]:
        closing = minimum_jerk((times - moment) / _CLOSING)
        opening = minimum_jerk((times - moment - _CLOSING) / _OPENING)
        lid_closure = np.maximum(lid_closure, closing - opening)
        moment += max(rng.gamma(3.0, average / 3.0), 0.4)
    return lid_closure


def speaking_mouth(
    audio: Audio, prosody: Prosody, times: Floats, opening: float
) -> Mapping[str, Floats]:
    """Return the weights of the mouth's actions, each of shape (T,); silence gives zeros.

    Three bands of the spectrum drive jaw, spread and rounded lips, as in Llorach, Evans, Blat,
    Grimm & Hohmann (2016), "Web-based live speech-driven lip-sync": openness follows the energy of
    the first formant, spread lips that of the second, and rounding their absence. Only ARKit
    actions move the mouth; the jaw joint stays still, since the body maps both.

    Parameters
    ----------
    audio : Audio
    prosody : Prosody
        Prosody of the speech, on the frames of `times`.
    times : ndarray, shape (T,)
        Seconds.
    opening : float
        Scale of the mouth's opening; 1 is usual.
    """
    share = _band_shares(audio, times)
    loudness = np.clip((prosody.energy - _SPEECH_ENERGY) / (1 - _SPEECH_ENERGY), 0, 1)
    width = max(_LIP_INERTIA * prosody.frame_rate, 1e-3)

    def lips(weight: Floats) -> Floats:
        return np.asarray(gaussian_filter1d(weight, width, mode="nearest"))

    voiced = loudness * (1 - share["hiss"])
    openness = voiced * (0.35 + 0.65 * share["open"])
    spread = voiced * share["front"]
    rounded = voiced * np.clip(1 - share["open"] - share["front"], 0, 1)
    # Lips or tongue close in the dip between two syllables.
    surrounding = gaussian_filter1d(loudness, 4 * width, mode="nearest")
    closing = np.clip(surrounding - loudness, 0, 1) * (surrounding > 0.15)
    return {
        "jawOpen": lips(_JAW * opening * openness),
        "mouthLowerDown": lips(0.3 * opening * openness + 0.25 * loudness * share["hiss"]),
        "mouthUpperUp": lips(0.16 * opening * openness + 0.1 * loudness * share["hiss"]),
        "mouthStretch": lips(0.3 * spread),
        "mouthSmile": lips(0.14 * spread),
        "mouthFunnel": lips(0.4 * rounded),
        "mouthPucker": lips(0.35 * rounded),
        "mouthPress": lips(0.5 * closing),
        "mouthRollLower": lips(0.3 * closing),
    }


def _band_shares(audio: Audio, times: Floats) -> dict[str, Floats]:
    """Return the shares of open vowels, front vowels and hiss at each time, in [0, 1]."""
    rate = audio.sample_rate
    window = np.hanning(max(round(_WINDOW * rate), 4))
    transform = ShortTimeFFT(window, max(round(_HOP * rate), 1), rate)
    samples = np.pad(
        np.asarray(audio.samples, float), (0, max(0, len(window) - len(audio.samples)))
    )
    power = np.abs(transform.stft(samples)) ** 2
    moments = transform.t(len(samples))
    frequency = transform.f

    def band(limits: tuple[float, float]) -> Floats:
        in_band = (frequency >= limits[0]) & (frequency < limits[1])
        return np.asarray(np.interp(times, moments, np.sqrt(power[in_band].sum(axis=0))))

    voice, hiss = band(_VOICE) + 1e-9, band(_HISS)
    return {
        "open": _stretch(band(_FIRST_FORMANT_OPEN) / voice),
        "front": _stretch(band(_SECOND_FORMANT_FRONT) / voice),
        "hiss": hiss / (hiss + voice),
    }


def _stretch(share: Floats) -> Floats:
    """Scale `share` so that the low and high values of this voice become 0 and 1."""
    low, high = np.percentile(share, [15, 95])
    return np.asarray(np.clip((share - low) / max(high - low, 1e-6), 0, 1))
