"""The corpus' truth about its takes."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.learned_motion.following import Speech
from benchmarks.learned_motion.recordings import FRAME_RATE
from motion.audio import read_audio
from motion.audio_analysis import speech_onsets
from training.data.take import Take

FloatArray = NDArray[np.float64]


def speeches(corpus: Path, takes: Sequence[Take]) -> dict[str, Speech]:
    """Return the truth about each take's speech, at the clips' frame rate."""
    return {take.name: _speech(corpus, take) for take in takes}


def spoken(corpus: Path, takes: Sequence[Take]) -> dict[str, str]:
    """Return speaker and text of each take, which takes of one text by one speaker share."""
    return {take.name: f"{take.speaker}: {_truth(corpus, take)['text']}" for take in takes}


def _speech(corpus: Path, take: Take) -> Speech:
    audio = read_audio(take.speech)
    truth = _truth(corpus, take)
    frames = round(audio.duration * FRAME_RATE)
    return Speech(
        wrist_speed=_at_frames(truth["drive_wrist_speed"], float(truth["frame_rate"]), frames),
        jaw_open=_at_frames(truth["drive_jaw_open"], float(truth["frame_rate"]), frames),
        onsets=speech_onsets(audio),
        strokes=truth["stroke_times"],
    )


def _at_frames(curve: FloatArray, frame_rate: float, frames: int) -> FloatArray:
    return np.interp(np.arange(frames) / FRAME_RATE, np.arange(len(curve)) / frame_rate, curve)


def _truth(corpus: Path, take: Take) -> Mapping[str, FloatArray]:
    return np.load(corpus / "truth" / f"{take.name}.npz")  # type: ignore[no-any-return]
