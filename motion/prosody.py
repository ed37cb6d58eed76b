"""Prosody of a stretch of speech: loudness, syllables and accents.

Definitions
-----------
energy
    Root mean square of 25 ms (Hann) around each instant, smoothed over a syllable's attack
    (Gaussian, 20 ms), in decibels below the segment's own loud level (its 95th percentile),
    mapped linearly so that -35 dB and less is 0 and the loud level is 1.
pitch
    Fundamental frequency by probabilistic YIN (Mauch & Dixon 2014), 65 to 500 Hz; a frame that
    it calls unvoiced has none.
syllable
    A nucleus: a peak of the energy envelope, at least 0.12 s from any louder one.
accent
    A syllable that stands out by loudness and by pitch together. Loudness prominence is how far
    the envelope rises above the average of the speech around it (Gaussian, 0.75 s), pitch
    prominence how far the pitch within 80 ms is above the median of 1.5 s to either side, in
    semitones; both are divided by their spread over the segment's syllables. Loudness counts twice:
    it is the better single cue (Kochanski et al. 2005, "Loudness predicts prominence"). The
    stronger half of the syllables is accented.
"""

from dataclasses import dataclass
from typing import Final

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import find_peaks

from motion.arrays import Floats, Indices
from motion.audio import SPEECH_RATE, Audio
from motion.audio_analysis import load_librosa

_HOP: Final = 160
_STEPS_PER_SECOND: Final = SPEECH_RATE / _HOP
_WINDOW: Final = 400
_PITCH_WINDOW: Final = 1024
_LOWEST_PITCH: Final = 65.0
_HIGHEST_PITCH: Final = 500.0
_DYNAMIC_RANGE: Final = 35.0
_SMOOTHING: Final = 0.02
_SILENCE: Final = 1e-4
_PAUSE_ENERGY: Final = 0.25
_SHORTEST_SYLLABLE: Final = 0.12
_CONTEXT: Final = 1.5
_NUCLEUS_RADIUS: Final = 0.08
_MIN_RISE: Final = 0.06
_AUDIBLE_ENERGY: Final = 1 / _DYNAMIC_RANGE
_AUDIBLE_PITCH: Final = 0.5


@dataclass(frozen=True, kw_only=True, eq=False)
class Prosody:
    """Prosody on the frames of a motion clip and as moments in time.

    Attributes
    ----------
    frame_rate : float
        Frames per second of `energy`; frame k stands for time ``k / frame_rate``.
    energy : ndarray, shape (T,)
        Loudness in [0, 1], relative to the segment's own loud level.
    syllables : ndarray, shape (S,)
        Times of all syllable nuclei in seconds, ascending.
    accents : ndarray, shape (A,)
        Times of the accented syllables in seconds, ascending.
    prominence : ndarray, shape (A,)
        How much each accent stands out, in (0, 1]; the strongest of the segment is 1.
    """

    frame_rate: float
    energy: Floats
    syllables: Floats
    accents: Floats
    prominence: Floats


def prosody(audio: Audio, frame_rate: float) -> Prosody:
    """Measure the prosody of `audio`.

    Parameters
    ----------
    audio : Audio
        Speech, mono.
    frame_rate : float
        Frames per second of the result's energy, which has ``round(audio.duration * frame_rate)``
        values.

    Returns
    -------
    Prosody
        Silent audio has energy 0 and no accents.
    """
    frames = round(audio.duration * frame_rate)
    samples = audio.samples_at(SPEECH_RATE)
    energy = _energy(samples)
    nuclei = _nuclei(energy)
    accents, prominence = _accents(energy, _pitch(samples, energy), nuclei)
    steps = np.arange(len(energy)) / _STEPS_PER_SECOND
    times = np.arange(frames) / frame_rate
    return Prosody(
        frame_rate=float(frame_rate),
        energy=np.clip(np.interp(times, steps, energy), 0, 1),
        syllables=nuclei / _STEPS_PER_SECOND,
        accents=accents,
        prominence=prominence,
    )


def _energy(samples: Floats) -> Floats:
    """Return the energy envelope, one value per analysis step; 1 is the loud level, not a cap."""
    window = np.hanning(_WINDOW)
    power = np.convolve(samples**2, window / window.sum())
    power = power[_WINDOW // 2 :: _HOP][: len(samples) // _HOP + 1]
    level = np.sqrt(gaussian_filter1d(power, _SMOOTHING * _STEPS_PER_SECOND))
    loud = float(np.percentile(level, 95))
    if loud < _SILENCE:
        return np.zeros_like(level)
    decibels = 20 * np.log10(np.maximum(level, _SILENCE * loud) / loud)
    return np.asarray(np.maximum(1 + decibels / _DYNAMIC_RANGE, 0))


def _pitch(samples: Floats, energy: Floats) -> Floats:
    """Return the fundamental frequency in Hz, one value per analysis step, NaN unvoiced."""
    if not energy.any() or len(samples) < _PITCH_WINDOW:
        return np.full(len(energy), np.nan)
    librosa = load_librosa()
    frequencies, _, _ = librosa.pyin(
        samples,
        fmin=_LOWEST_PITCH,
        fmax=_HIGHEST_PITCH,
        sr=SPEECH_RATE,
        frame_length=_PITCH_WINDOW,
        hop_length=_HOP,
        resolution=0.25,
    )
    pitch = np.full(len(energy), np.nan)
    length = min(len(energy), len(frequencies))
    pitch[:length] = frequencies[:length]
    pitch[energy < _PAUSE_ENERGY] = np.nan
    return pitch


def _nuclei(energy: Floats) -> Indices:
    """Return the analysis steps of the syllable nuclei."""
    nuclei, _ = find_peaks(
        energy,
        height=_PAUSE_ENERGY,
        prominence=_MIN_RISE,
        distance=round(_SHORTEST_SYLLABLE * _STEPS_PER_SECOND),
    )
    return nuclei


def _accents(energy: Floats, pitch: Floats, nuclei: Indices) -> tuple[Floats, Floats]:
    """Return the times of the accented syllables and how much each stands out."""
    if not len(nuclei):
        return np.zeros(0), np.zeros(0)
    loudness = _rise_of_energy(energy)[nuclei]
    height = _height_of_pitch(pitch, nuclei)
    score = (
        2 * _standardised(loudness, _AUDIBLE_ENERGY) + _standardised(height, _AUDIBLE_PITCH)
    ) / 3
    strong = score >= np.median(score) - 1e-9
    peak = score[strong]
    lowest, highest = float(peak.min()), float(peak.max())
    span = highest - lowest
    prominence = 0.2 + 0.8 * (peak - lowest) / span if span > 1e-9 else np.ones(len(peak))
    return nuclei[strong] / _STEPS_PER_SECOND, prominence


def _rise_of_energy(energy: Floats) -> Floats:
    """Return each step's energy above the average of the speech around it."""
    speech = (energy >= _PAUSE_ENERGY).astype(float)
    width = _CONTEXT / 2 * _STEPS_PER_SECOND
    share = gaussian_filter1d(speech, width, mode="nearest")
    mean = gaussian_filter1d(energy * speech, width, mode="nearest") / np.maximum(share, 1e-9)
    return np.asarray(energy - mean)


def _height_of_pitch(pitch: Floats, nuclei: Indices) -> Floats:
    """Return the pitch at each nucleus relative to the pitch around it, in semitones.

    The pitch around it, because pitch falls over an utterance (declination).
    """
    near, far = (
        round(_NUCLEUS_RADIUS * _STEPS_PER_SECOND),
        round(_CONTEXT * _STEPS_PER_SECOND),
    )
    heights = np.zeros(len(nuclei))
    for index, nucleus in enumerate(nuclei):
        at_nucleus = pitch[max(nucleus - near, 0) : nucleus + near + 1]
        context = pitch[max(nucleus - far, 0) : nucleus + far + 1]
        if np.isfinite(at_nucleus).any():
            # The 80th percentile, not the highest: pitch trackers jump an octave at creaky edges.
            heights[index] = 12 * np.log2(np.nanpercentile(at_nucleus, 80) / np.nanmedian(context))
    return heights


def _standardised(values: Floats, least_spread: float) -> Floats:
    """Return `values` minus their mean, divided by their spread or `least_spread` if larger.

    Otherwise inaudible differences would count as much as audible ones.
    """
    return np.asarray((values - values.mean()) / max(float(values.std()), least_spread))
