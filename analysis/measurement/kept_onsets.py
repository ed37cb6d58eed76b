"""Onsets of speech, found once per excerpt and kept on disk."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.measurement.kept_arrays import KeptArrays
from motion.audio import read_audio
from motion.speech_onsets import speech_onsets

FloatArray = NDArray[np.float64]

VERSION: Final = "1"
"""Raised whenever onsets come out otherwise."""


def onsets_of(recording: Path, start: float, end: float, folder: Path | None) -> FloatArray:
    """Return when sounds begin in an excerpt.

    Parameters
    ----------
    recording : Path
        The sound file.
    start, end : float
        Where the excerpt lies in it, in seconds; infinity for its end.
    folder : Path or None
        Where onsets are kept between runs.

    Returns
    -------
    ndarray, shape (N,)
        Seconds from the start of the excerpt, of single precision whether found or read.

    Raises
    ------
    InputError
        If the file cannot be read, or the excerpt does not lie in it.
    """
    place = None
    if folder is not None:
        place = _kept(folder).place(recording, _settings(start, end))
        found = KeptArrays.read(place, (None,))
        if found is not None:
            return found.astype(np.float64)
    audio = read_audio(recording)
    excerpt = audio.cut(start, audio.duration if math.isinf(end) else end)
    onsets = speech_onsets(excerpt).astype(np.float32)
    if place is not None:
        KeptArrays.keep(place, onsets)
    return onsets.astype(np.float64)


def forget_other_onsets(folder: Path) -> None:
    """Remove onsets that another version of the code has kept."""
    _kept(folder).forget_versions()


def _settings(start: float, end: float) -> str:
    return f"{start!r} {end!r}"


@lru_cache(maxsize=8)
def _kept(folder: Path) -> KeptArrays:
    return KeptArrays(folder, "onsets", VERSION)
