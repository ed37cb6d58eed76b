"""How much Speech2UnifiedExpressions jerks where one window goes over into the next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from analysis.metrics.result import MetricResult
from benchmarks.seams import seams_of_clip
from generators.interface import SpeechSegment
from generators.s2ue.generate import S2ue
from generators.s2ue.settings import S2ueSettings
from motion.audio import SPEECH_RATE, Audio, read_audio
from motion.segment import Segment

_RATE: Final = 15.0


def seams(checkpoint: Path, speech: Sequence[Path]) -> Iterator[MetricResult]:
    """Yield `seams_of_clip` of the motion to files that are spoken one after the other."""
    audio = Audio(np.concatenate([read_audio(path).samples for path in speech]), SPEECH_RATE)
    segment = Segment(
        name="all", wav="all.wav", start=0, end=audio.duration, speaker="all", emotion="neutral"
    )
    made = S2ue(S2ueSettings(checkpoint=checkpoint))
    spoken = SpeechSegment(segment=segment, audio=audio)
    yield from seams_of_clip(made.generate(spoken, seed=1, frame_rate=_RATE))
