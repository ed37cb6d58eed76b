"""A whole small study with really playing videos, made without generators or renderer."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio, write_wav
from motion.segment import Segment, write_segments
from renderer.encoder import SOUND_RATE, VideoWriter, video_frame
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
    silence = Audio(np.zeros(round(16_000 * seconds * len(EMOTIONS)), np.float32), 16_000)
    write_wav(folder / "speech" / "take.wav", silence)
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
    """Write pictures (height, width, 3) with a tone, as the renderer does."""
    path.parent.mkdir(parents=True, exist_ok=True)
    moments = np.arange(round(seconds * SOUND_RATE)) / SOUND_RATE
    tone = Audio((0.1 * np.sin(2 * np.pi * 220 * moments)).astype(np.float32), SOUND_RATE)
    frames = list(pictures)
    height, width, _ = frames[0].shape
    with VideoWriter(path, width, height, FRAME_RATE, tone) as writer:
        for frame in frames:
            writer.write(video_frame(frame))


def _picture(index: int, shade: int) -> NDArray[np.uint8]:
    """Return a frame: on each side a bar that swings, for something to be seen moving."""
    picture = np.full((HEIGHT, 2 * HEIGHT, 3), BACKGROUND, dtype=np.uint8)
    swing = int(30 * np.sin(index / 3))
    for side, direction in ((0, 1), (HEIGHT, -1)):
        left = side + HEIGHT // 2 - 10 + direction * swing
        picture[30:110, left : left + 20] = (shade % 200, 90, 140)
    return picture
