"""Short recordings: speech whose loudness rises and falls, and an arm that sinks."""

from pathlib import Path

import numpy as np

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip

RATE = 16_000


def write_speech(path: Path, seconds: float) -> Path:
    times = np.arange(round(seconds * RATE)) / RATE
    loudness = 0.5 + 0.5 * np.sin(2 * np.pi * 2.5 * times)
    samples = (0.3 * loudness * np.sin(2 * np.pi * 150 * times)).astype(np.float32)
    write_wav(path, Audio(samples=samples, sample_rate=RATE))
    return path


def write_motion(path: Path, seconds: float, frame_rate: float = 30) -> Path:
    frames = round(seconds * frame_rate)
    poses = np.zeros((frames, 55, 3), np.float32)
    poses[:, 16, 2] = np.linspace(0, -1, frames)
    write_clip(
        path,
        MotionClip(poses=poses, trans=np.zeros((frames, 3), np.float32), frame_rate=frame_rate),
    )
    return path
