"""A whole small study with really playing videos, made without generators or renderer."""

from __future__ import annotations

import wave
from collections.abc import Iterable
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

from motion.segment import Segment, write_segments
from studyapp.study.media import PairVideo, Stimuli, write_stimuli

EMOTIONS = ("happiness", "anger", "sadness", "neutral")
PAIRS = (
    ("rule_based", "mismatched"),
    ("mismatched", "rule_based"),
    ("rule_based", "broken"),
    ("broken", "rule_based"),
)
SECONDS = 2.0
FRAME_RATE = 15
SAMPLE_RATE = 48_000
HEIGHT = 120
BACKGROUND = 0xEC

STUDY_FILE = """\
name = "tiny"
title = "Gestures and speech"
reference = "rule_based"
participants_per_comparison = 4
trials = 4
practice = 1

[conditions.rule_based]
[conditions.mismatched]

[catch]
trials = 1
condition = "broken"
generator = "broken"

[[questions]]
name = "rhythm"
title = "Rhythm"
text = "In which video do the gestures fit the rhythm of the speech better?"

[[questions]]
name = "emotion"
title = "Emotion"
text = "The speaker feels {emotion}. In which video do the gestures show it better?"

[page]
organisation = "Institute of Gestures"
contact = "gestures@example.org"
minutes = 10
payment = "2.50 EUR"
consent = \"\"\"
You will watch short videos of an animated speaker.

Taking part is voluntary.\"\"\"
"""
"""One comparison, four places, four pairs of which one is practice, one catch trial: six
presentations of two questions each."""


def write_tiny_study(folder: Path, *, seconds: float = SECONDS) -> None:
    """Write the study of `STUDY_FILE` into `folder`, with one segment per emotion."""
    (folder / "study.toml").write_text(STUDY_FILE, encoding="utf-8")
    (folder / "speech").mkdir()
    _write_speech(folder / "speech" / "take.wav", seconds * len(EMOTIONS))
    segments = [
        Segment(
            name=f"take-{index}",
            wav="take.wav",
            start=index * seconds,
            end=(index + 1) * seconds,
            speaker="robin",
            emotion=emotion,
        )
        for index, emotion in enumerate(EMOTIONS)
    ]
    write_segments(folder / "speech", segments)
    pairs: list[PairVideo] = []
    for segment in segments:
        for left, right in PAIRS:
            file = f"videos/pairs/{len(pairs):03}.mp4"
            write_pair_video(folder / file, shade=60 + 10 * len(pairs), seconds=seconds)
            pairs.append(
                PairVideo(
                    segment=segment.name,
                    left=left,
                    right=right,
                    file=file,
                    duration=seconds,
                    key=str(len(pairs)),
                )
            )
    write_stimuli(folder / "stimuli.json", Stimuli(pairs=tuple(pairs)))


def write_pair_video(path: Path, *, shade: int, seconds: float = SECONDS) -> None:
    """Write two squares side by side, as the renderer makes pairs."""
    pictures = (_picture(index, shade) for index in range(int(seconds * FRAME_RATE)))
    write_video(path, pictures, seconds=seconds)


def write_video(path: Path, pictures: Iterable[NDArray[np.uint8]], *, seconds: float) -> None:
    """Write pictures (height, width, 3) with a tone, as H.264 and AAC in MP4."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(path, "w", options={"movflags": "+faststart"}) as container:
        video = container.add_stream("libx264", rate=FRAME_RATE, options={"crf": "28"})
        audio = container.add_stream("aac", rate=SAMPLE_RATE, layout="mono")
        for number, picture in enumerate(pictures):
            if number == 0:
                video.height, video.width, _ = picture.shape
                video.pix_fmt = "yuv420p"
            container.mux(video.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(video.encode(None))
        for start in range(0, int(seconds * SAMPLE_RATE), 1024):
            stop = min(start + 1024, int(seconds * SAMPLE_RATE))
            tone = 0.1 * np.sin(2 * np.pi * 220 * np.arange(start, stop) / SAMPLE_RATE)
            sound = av.AudioFrame.from_ndarray(
                tone.astype(np.float32)[None], format="fltp", layout="mono"
            )
            sound.sample_rate, sound.pts = SAMPLE_RATE, start
            sound.time_base = Fraction(1, SAMPLE_RATE)
            container.mux(audio.encode(sound))
        container.mux(audio.encode(None))


def _picture(index: int, shade: int) -> NDArray[np.uint8]:
    """Return a frame: on each side a bar that swings, for something to be seen moving."""
    picture = np.full((HEIGHT, 2 * HEIGHT, 3), BACKGROUND, dtype=np.uint8)
    swing = int(30 * np.sin(index / 3))
    for side, direction in ((0, 1), (HEIGHT, -1)):
        left = side + HEIGHT // 2 - 10 + direction * swing
        picture[30:110, left : left + 20] = (shade % 200, 90, 140)
    return picture


def _write_speech(path: Path, seconds: float) -> None:
    with wave.open(str(path), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(16_000)
        file.writeframes(bytes(2 * int(16_000 * seconds)))
