"""Motion and finished videos of conditions that move very differently."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.audio import Audio, read_audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip
from motion.segment import Segment, write_segments
from motion.skeleton import joint_index
from renderer.encoder import SOUND_RATE
from renderer.look import BACKGROUND
from tests.support.encoded import VideoRecipe, write_video

SIZE: Final = 64
FRAME_RATE: Final = 10
SEGMENTS: Final = 6
EMOTIONS: Final = ("happiness", "anger", "sadness")

PICTURE: Final = MappingProxyType({"crf": "18", "bf": "0", "sc_threshold": "0"})
"""How `motionjury check` asks finished videos to be encoded."""

SWINGS: Final = MappingProxyType({"still": 0.0, "calm": 6.0, "lively": 20.0, "broken": 30.0})
"""How many pixels the figure of each condition swings; a broken one jumps about as well."""


def write_speech(folder: Path) -> tuple[Segment, ...]:
    """Write speech of different lengths and loudness, and return its segments."""
    segments = []
    for number in range(SEGMENTS):
        seconds = 0.3 + number / FRAME_RATE
        noise = np.random.default_rng(number).normal(0, 0.02 + 0.01 * (number % 3), SOUND_RATE * 2)
        swell = np.abs(np.sin(np.arange(len(noise)) / (2000 + 500 * number)))
        write_wav(folder / f"{number}.wav", Audio((noise * swell).astype(np.float32), SOUND_RATE))
        segments.append(
            Segment(
                name=f"s{number}",
                wav=f"{number}.wav",
                start=0.0,
                end=seconds,
                speaker="robin",
                emotion=EMOTIONS[number % len(EMOTIONS)],
            )
        )
    write_segments(folder, segments)
    return tuple(segments)


def pictures(condition: str, segment: Segment) -> Iterator[NDArray[np.uint8]]:
    """Yield the frames of a figure that swings as much as its condition does."""
    chance = np.random.default_rng([*segment.name.encode(), *condition.encode()])
    phase = chance.uniform(0, 6)
    for index in range(round(segment.duration * FRAME_RATE)):
        picture = np.full((SIZE, SIZE, 3), BACKGROUND, np.uint8)
        left = round(26 + SWINGS[condition] * np.sin(index + phase) * 0.8)
        picture[16:60, left : left + 12] = (70, 90, 130)
        if condition == "broken":
            top, side = chance.integers(0, SIZE - 16, 2)
            picture[top : top + 16, side : side + 16] = chance.integers(0, 255, (16, 16, 3))
        yield picture


def write_motion(path: Path, condition: str, segment: Segment) -> None:
    """Write motion of a body whose arm swings as much as its condition does."""
    chance = np.random.default_rng([*segment.name.encode(), *condition.encode()])
    frames = round(segment.duration * FRAME_RATE)
    poses = np.zeros((frames, 55, 3), np.float32)
    swing = SWINGS[condition] / 20
    poses[:, joint_index("left_shoulder"), 2] = swing * np.sin(
        np.arange(frames) + chance.uniform(0, 6)
    )
    if condition == "broken":
        poses += chance.normal(0, 0.3, poses.shape)
    trans = np.zeros((frames, 3), np.float32)
    write_clip(path, MotionClip(poses=poses, trans=trans, frame_rate=FRAME_RATE))


TOOLS: Final = MappingProxyType(
    {
        "still": VideoRecipe(),
        "calm": VideoRecipe(
            name="CalmNet",
            language="jpn",
            tags={"comment": "checkpoint 12", "date": "2026-05-04"},
            layout={"movflags": "+faststart", "video_track_timescale": "12800"},
            sound_bits=48_000,
        ),
        "lively": VideoRecipe(
            tags={"encoder": "Recorder of a camera", "artist": "somebody"},
            layout={"movflags": "+faststart+use_metadata_tags", "brand": "mp42"},
            sound_bits=160_000,
        ),
        "broken": VideoRecipe(name="jitter", layout={"movie_timescale": "600"}),
    }
)
"""How the tools of the conditions write their files."""


def write_brought(path: Path, condition: str, segment: Segment, speech: Path) -> None:
    """Write a finished video as the tool of its condition would, which says so in the file."""
    sound = read_audio(speech / segment.wav, sample_rate=SOUND_RATE).cut(0.0, segment.end)
    tool = replace(TOOLS[condition], rate=FRAME_RATE, size=SIZE, encoder=PICTURE, sound=sound)
    write_video(path, tool, pictures(condition, segment))
