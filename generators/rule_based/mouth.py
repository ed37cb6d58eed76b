"""The speaking mouth: how far it opens and how it is shaped, from the sound alone.

Three bands of the spectrum stand for jaw, spread and rounded lips, as in Llorach, Evans, Blat,
Grimm & Hohmann (2016), "Web-based live speech-driven lip-sync": openness goes with the energy of
the first formant, spread lips with the second's, rounding with their absence. The mouth is moved
by the ARKit actions alone; the jaw joint stays still, since the body maps both.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import ShortTimeFFT

from motion.audio import Audio
from motion.speech.prosody import Prosody

FloatArray = NDArray[np.float64]

_FIRST_FORMANT_OPEN: Final = (450.0, 1100.0)
_SECOND_FORMANT_FRONT: Final = (1600.0, 2800.0)
_VOICE: Final = (80.0, 2800.0)
_HISS: Final = (3500.0, 7500.0)
_WINDOW: Final = 0.025
_HOP: Final = 0.01
_LIP_INERTIA: Final = 0.03
_SPEAKING: Final = 0.3
_JAW: Final = 0.42


def speaking_mouth(
    audio: Audio, prosody: Prosody, times: FloatArray, opening: float
) -> Mapping[str, FloatArray]:
    """Return the weights of the mouth's actions, each of shape (T,); silence gives zeros.

    Parameters
    ----------
    audio : Audio
    prosody : Prosody
        On the frames of `times`.
    times : ndarray, shape (T,)
        Seconds.
    opening : float
        How widely this speaker opens the mouth; 1 is usual.
    """
    share = _band_shares(audio, times)
    loud = np.clip((prosody.energy - _SPEAKING) / (1 - _SPEAKING), 0, 1)
    width = max(_LIP_INERTIA * prosody.frame_rate, 1e-3)

    def lips(weight: FloatArray) -> FloatArray:
        return np.asarray(gaussian_filter1d(weight, width, mode="nearest"))

    voiced = loud * (1 - share["hiss"])
    openness = voiced * (0.35 + 0.65 * share["open"])
    spread = voiced * share["front"]
    rounded = voiced * np.clip(1 - share["open"] - share["front"], 0, 1)
    # A dip between two syllables is where lips or tongue close.
    around = gaussian_filter1d(loud, 4 * width, mode="nearest")
    closing = np.clip(around - loud, 0, 1) * (around > 0.15)
    return {
        "jawOpen": lips(_JAW * opening * openness),
        "mouthLowerDown": lips(0.3 * opening * openness + 0.25 * loud * share["hiss"]),
        "mouthUpperUp": lips(0.16 * opening * openness + 0.1 * loud * share["hiss"]),
        "mouthStretch": lips(0.3 * spread),
        "mouthSmile": lips(0.14 * spread),
        "mouthFunnel": lips(0.4 * rounded),
        "mouthPucker": lips(0.35 * rounded),
        "mouthPress": lips(0.5 * closing),
        "mouthRollLower": lips(0.3 * closing),
    }


def _band_shares(audio: Audio, times: FloatArray) -> dict[str, FloatArray]:
    """Return in [0, 1] how much open vowels, front vowels and hiss there are at each time."""
    rate = audio.sample_rate
    window = np.hanning(max(round(_WINDOW * rate), 4))
    transform = ShortTimeFFT(window, max(round(_HOP * rate), 1), rate)
    samples = np.pad(
        np.asarray(audio.samples, float), (0, max(0, len(window) - len(audio.samples)))
    )
    power = np.abs(transform.stft(samples)) ** 2
    moments = transform.t(len(samples))
    frequency = transform.f

    def band(limits: tuple[float, float]) -> FloatArray:
        inside = (frequency >= limits[0]) & (frequency < limits[1])
        return np.asarray(np.interp(times, moments, np.sqrt(power[inside].sum(axis=0))))

    voice, hiss = band(_VOICE) + 1e-9, band(_HISS)
    return {
        "open": _stretch(band(_FIRST_FORMANT_OPEN) / voice),
        "front": _stretch(band(_SECOND_FORMANT_FRONT) / voice),
        "hiss": hiss / (hiss + voice),
    }


def _stretch(share: FloatArray) -> FloatArray:
    """Return `share` stretched so that this voice's own low and high values are 0 and 1."""
    low, high = np.percentile(share, [15, 95])
    return np.asarray(np.clip((share - low) / max(high - low, 1e-6), 0, 1))
