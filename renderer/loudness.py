"""One loudness for every video of a study, by EBU R 128."""

import math
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Final

import av
import numpy as np
from av.filter import Graph

from motion.audio import Audio, read_audio
from renderer.encoder import SOUND_RATE

TARGET: Final = -23.0
"""LUFS, as recommended by EBU R 128. Speech usually reaches it without limiting its peaks."""

PEAK_CEILING: Final = -1.0
"""Largest true peak in dBTP (EBU R 128, section k)."""

SHORTEST: Final = 0.4
"""Seconds of one measuring block (ITU-R BS.1770-5, annex 1); shorter sound has no loudness."""

_SILENCE: Final = -70.0  # the absolute gate; FFmpeg reports it if no block is above
_OVERSAMPLING: Final = 4


def at_common_loudness(audio: Audio) -> Audio:
    """Return `audio` at the loudness that all videos share; only its gain changes.

    Parameters
    ----------
    audio : Audio
        The speech, already cut.

    Returns
    -------
    Audio
        At `TARGET`, or as near below it as `PEAK_CEILING` allows. Sound without a measurable
        loudness keeps its level.
    """
    loudness = integrated_loudness(audio)
    if loudness is None:
        return audio
    gain = min(TARGET - loudness, PEAK_CEILING - true_peak(audio))
    return replace(audio, samples=audio.samples * np.float32(10 ** (gain / 20)))


def read_excerpt(speech: Path, start: float, end: float) -> Audio:
    """Return an excerpt of a recording as videos play it, from `start` to `end` in seconds."""
    return at_common_loudness(read_audio(speech, sample_rate=SOUND_RATE).cut(start, end))


def integrated_loudness(audio: Audio) -> float | None:
    """Return the integrated loudness in LUFS; None if it is silent or too short.

    Measured by FFmpeg's ``ebur128`` filter (ITU-R BS.1770, annex 1: K weighting, blocks of
    400 ms, gates at -70 LUFS and 10 LU below the mean of the louder blocks).
    """
    if audio.duration < SHORTEST:
        return None
    rate = audio.sample_rate
    graph = Graph()
    source = graph.add_abuffer(
        format="fltp", sample_rate=rate, layout="mono", time_base=Fraction(1, rate)
    )
    meter = graph.add("ebur128", "metadata=1")
    sink = graph.add("abuffersink")
    source.link_to(meter)
    meter.link_to(sink)
    graph.configure()
    frame = av.AudioFrame.from_ndarray(audio.samples[None], format="fltp", layout="mono")
    frame.sample_rate, frame.pts, frame.time_base = rate, 0, Fraction(1, rate)
    source.push(frame)
    source.push(None)
    loudness = _SILENCE
    while True:
        try:
            metered = sink.pull()
        except av.error.EOFError:
            break
        loudness = float(metered.metadata.get("lavfi.r128.I", loudness))
    return loudness if loudness > _SILENCE else None


def true_peak(audio: Audio) -> float:
    """Return the true peak in dBTP; -inf for silence.

    Measured by fourfold oversampling (ITU-R BS.1770, annex 2).
    """
    # Imported here: it takes half a second, and few commands play sound.
    from scipy.signal import resample_poly

    oversampled = resample_poly(audio.samples, _OVERSAMPLING, 1)
    peak = max(float(np.abs(oversampled).max()), float(np.abs(audio.samples).max()))
    return 20 * math.log10(peak) if peak > 0 else -math.inf
