"""How fast videos are made on this machine: ``python -m renderer.benchmark``."""

from __future__ import annotations

import os

from renderer.jobs import ONE_THREAD

os.environ.update(ONE_THREAD)  # before NumPy and Mesa load: measured as in a worker

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np

from motion.audio import Audio, write_wav
from motion.body import read_body
from motion.clip import MotionClip
from motion.formats import write_clip
from motion.skeleton import joint_index
from renderer.body_asset import default_body
from renderer.clip_video import Stage, write_clip_video
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.framing import frame_clips
from renderer.look import Look
from renderer.pair import write_pair

SECONDS: Final = 10.0


def gesturing_clip(seconds: float, frame_rate: float) -> MotionClip:
    """Return a clip in which arms, head and jaw move all the time."""
    time_of = np.arange(round(seconds * frame_rate)) / frame_rate
    poses = np.zeros((len(time_of), 55, 3), np.float32)
    for side, sign in (("left", -1.0), ("right", 1.0)):
        poses[:, joint_index(f"{side}_shoulder")] = (0.0, 0.0, sign * 1.15)
        poses[:, joint_index(f"{side}_elbow"), 1] = sign * (1.2 + 0.4 * np.sin(3 * time_of))
    poses[:, joint_index("head"), 1] = 0.2 * np.sin(1.3 * time_of)
    poses[:, joint_index("jaw"), 0] = 0.1 + 0.1 * np.sin(14 * time_of)
    return MotionClip(
        poses=poses, trans=np.zeros((len(time_of), 3), np.float32), frame_rate=frame_rate
    )


def main() -> None:
    """Print frames per second of a clip, a pair, and encoding alone, in one process."""
    look = Look()
    clip = gesturing_clip(SECONDS, look.frame_rate)
    body = default_body()
    camera = frame_clips([clip], read_body(body), look)
    sound = Audio(np.zeros(round(SECONDS * SOUND_RATE), np.float32), SOUND_RATE)
    with tempfile.TemporaryDirectory() as name, Stage(body, camera, look) as stage:
        folder = Path(name)
        motion, speech, frames = folder / "clip.npz", folder / "speech.wav", folder / "clip.mkv"
        write_clip(motion, clip)
        write_wav(speech, sound)
        kept = list(stage.video_frames(clip))

        def make_clip() -> None:
            write_clip_video(
                stage,
                motion=motion,
                speech=speech,
                start=0.0,
                end=SECONDS,
                frozen=(),
                frames=frames,
                video=folder / "clip.mp4",
            )

        def make_pair() -> None:
            write_pair(
                left=frames,
                right=frames,
                speech=speech,
                start=0.0,
                end=SECONDS,
                video=folder / "pair.mp4",
                look=look,
            )

        def encode() -> None:
            with VideoWriter(
                folder / "alone.mp4", look.size, look.size, look.frame_rate, sound
            ) as writer:
                for frame in kept:
                    writer.write(frame)

        print(f"one process, {look.size} x {look.size}, {len(clip)} frames; wall / CPU frames/s")
        for what, task in (
            ("clip (skin, draw, two encodings)", make_clip),
            ("drawing alone", lambda: sum(1 for _ in stage.video_frames(clip))),
            ("pair from rendered clips", make_pair),
            ("x264 and AAC alone, one clip", encode),
        ):
            print(f"{what:36} {_speed(task, len(clip))}")


def _speed(task: Callable[[], object], frames: int) -> str:
    """Return how many frames a second `task` makes, by the clock and by the processor's time."""
    wall, busy = time.perf_counter(), time.process_time()
    task()
    wall, busy = time.perf_counter() - wall, time.process_time() - busy
    return f"{frames / wall:7.1f} / {frames / busy:.1f}"


if __name__ == "__main__":
    main()
