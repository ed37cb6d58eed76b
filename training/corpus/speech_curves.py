"""Curves of speech that drive the process: loudness, pitch, brightness, and times of strokes.

Definitions
-----------
loudness
    Stevens' power law on the root mean square of 25 ms (Hann): ``(rms / 0.15) ** 0.6``, smoothed
    over 40 ms (Gaussian). A loud syllable is about 1; the scale is absolute.
slow loudness
    The same, smoothed over 0.35 s.
pitch
    Fundamental frequency by YIN (de Cheveigné & Kawahara 2002), 65 to 400 Hz, in octaves above
    100 Hz; averaged over 0.25 s (Gaussian) with the loudness as weight, 0 in silence.
sounding
    Share of speech in that mean, in [0, 1]: 0 in silence.
brightness
    Share of the power above 1500 Hz (of all above 100 Hz), averaged over 60 ms with the loudness
    as weight.
stroke
    Arrives when the voice rises fastest towards a loud syllable, a peak of the loudness of at least
    0.35 that stands out by 0.1 and is the loudest within the emotion's spacing. Its size is 1.6
    times the excess of the peak's loudness over 0.35: about 1 for a loud syllable.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import ShortTimeFFT, find_peaks

from motion.arrays import Floats
from motion.audio import SPEECH_RATE, Audio
from motion.audio_analysis import load_librosa

STEPS_PER_SECOND: Final = 100

_HOP: Final = SPEECH_RATE // STEPS_PER_SECOND
_WINDOW: Final = 400
_TRANSFORM: Final = 512
_PITCH_WINDOW: Final = 1024
_LOWEST_PITCH: Final = 65.0
_HIGHEST_PITCH: Final = 400.0
_REFERENCE_LEVEL: Final = 0.15
_POWER_LAW: Final = 0.6
_SYLLABLE: Final = 0.04
_SLOW: Final = 0.35
_MELODY: Final = 0.25
_SOUND: Final = 0.06
_AUDIBLE: Final = 0.05
_LOWEST_POWER: Final = 1e-9
_RUMBLE, _BRIGHT = 100.0, 1500.0


@dataclass(frozen=True, kw_only=True, eq=False)
class SpeechCurves:
    """Curves of a stretch of speech, at `STEPS_PER_SECOND`; step k is at ``k / 100`` seconds.

    Attributes
    ----------
    loudness, slow_loudness : ndarray, shape (S,)
        At least 0; about 1 is a loud syllable.
    pitch : ndarray, shape (S,)
        Octaves above 100 Hz, 0 in silence.
    sounding, brightness : ndarray, shape (S,)
        In [0, 1].
    """

    loudness: Floats
    slow_loudness: Floats
    pitch: Floats
    sounding: Floats
    brightness: Floats

    def at(self, curve: Floats, times: Floats) -> Floats:
        """Return one of the curves at `times` in seconds, interpolated linearly."""
        return np.interp(times, np.arange(len(curve)) / STEPS_PER_SECOND, curve)


def analyse(speech: Audio) -> SpeechCurves:
    """Return the curves of `speech`, mono at 16 kHz."""
    samples = np.asarray(speech.samples, np.float64)
    steps = len(samples) // _HOP + 1
    rms = _level(samples, steps)
    raw = (rms / _REFERENCE_LEVEL) ** _POWER_LAW
    loudness = _smooth(raw, _SYLLABLE)
    pitch = _octaves(samples, steps)
    melody = np.where(loudness > _AUDIBLE, pitch, 0.0)
    return SpeechCurves(
        loudness=loudness,
        slow_loudness=_smooth(raw, _SLOW),
        pitch=_weighted(melody, loudness, _MELODY),
        sounding=_weighted(np.ones(steps), loudness, _MELODY),
        brightness=_weighted(_brightness(samples, steps), loudness, _SOUND),
    )


def _level(samples: Floats, steps: int) -> Floats:
    """Return the root mean square around each step."""
    window = np.hanning(_WINDOW)
    power = np.convolve(samples**2, window / window.sum())
    return np.asarray(np.sqrt(power[_WINDOW // 2 :: _HOP][:steps]))


def _octaves(samples: Floats, steps: int) -> Floats:
    """Return the fundamental frequency in octaves above 100 Hz, whether voiced or not."""
    librosa = load_librosa()
    hertz = librosa.yin(
        samples,
        fmin=_LOWEST_PITCH,
        fmax=_HIGHEST_PITCH,
        sr=SPEECH_RATE,
        frame_length=_PITCH_WINDOW,
        hop_length=_HOP,
    )
    return np.asarray(np.log2(_with_length(np.asarray(hertz, np.float64), steps) / 100))


def _brightness(samples: Floats, steps: int) -> Floats:
    """Return the share of the power in the bright half of the spectrum."""
    transform = ShortTimeFFT(
        np.hanning(_WINDOW), hop=_HOP, fs=SPEECH_RATE, mfft=_TRANSFORM, scale_to="psd"
    )
    power = np.asarray(transform.spectrogram(samples, p0=0, p1=steps), np.float64)
    total = power[transform.f >= _RUMBLE].sum(axis=0)
    return np.asarray(power[transform.f >= _BRIGHT].sum(axis=0) / (total + _LOWEST_POWER))


def _with_length(values: Floats, steps: int) -> Floats:
    """Return `values` cut to `steps`, or extended with the last value."""
    return values[np.minimum(np.arange(steps), len(values) - 1)]


def _weighted(values: Floats, weights: Floats, seconds: float) -> Floats:
    """Return a weighted running mean; near 0 where there is hardly any weight."""
    weight = _smooth(weights, seconds)
    return np.asarray(_smooth(values * weights, seconds) / (weight + _AUDIBLE))


def _smooth(values: Floats, seconds: float) -> Floats:
    return np.asarray(gaussian_filter1d(values, seconds * STEPS_PER_SECOND, mode="nearest"))


STROKE_LOUDNESS: Final = 0.35
STROKE_PROMINENCE: Final = 0.1
_SIZE: Final = 1.6
_RISE: Final = 0.2
"""Seconds before the peak in which the voice rises to it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Strokes:
    """Strokes in temporal order.

    Attributes
    ----------
    times : ndarray, shape (N,)
        Arrival times in seconds.
    sizes : ndarray, shape (N,)
        At least 0; about 1 for a loud syllable.
    """

    times: Floats
    sizes: Floats


def find_strokes(curves: SpeechCurves, spacing: float) -> Strokes:
    """Return the strokes that speech prompts, at least about `spacing` seconds apart."""
    loudness = curves.loudness
    peaks, _ = find_peaks(
        loudness,
        height=STROKE_LOUDNESS,
        prominence=STROKE_PROMINENCE,
        distance=max(1, round(spacing * STEPS_PER_SECOND)),
    )
    slope = np.gradient(loudness)
    rise_steps = round(_RISE * STEPS_PER_SECOND)
    starts = np.maximum(peaks - rise_steps, 0)
    arrivals = [
        start + int(np.argmax(slope[start : peak + 1]))
        for start, peak in zip(starts, peaks, strict=True)
    ]
    return Strokes(
        times=np.array(arrivals, np.float64) / STEPS_PER_SECOND,
        sizes=_SIZE * (loudness[peaks] - STROKE_LOUDNESS),
    )


def stroke_shape(elapsed: Floats, attack: float, release: float) -> Floats:
    """Return the extent of a stroke of size 1, in [0, 1].

    Parameters
    ----------
    elapsed : ndarray
        Seconds since the stroke's arrival; negative before it.
    attack, release : float
        Seconds in which the stroke goes out and comes back, above 0. Both are minimum-jerk
        movements (Flash & Hogan 1985) from rest to rest, so that the hand is still on arrival.
    """
    rise = np.clip(1 + elapsed / attack, 0, 1)
    fall = np.clip(1 - elapsed / release, 0, 1)
    share = np.where(elapsed < 0, rise, fall)
    return np.asarray(share**3 * (10 - 15 * share + 6 * share**2))
