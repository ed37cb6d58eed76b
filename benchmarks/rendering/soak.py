"""Whether memory stays flat: ``python -m benchmarks.rendering.soak`` renders one long clip.

The clip is skinned, drawn, stored without loss and encoded, as a clip's job does. Prints the
resident memory after a tenth of the frames and at the end; by default there are 10,000 frames.
"""

import os

from renderer.jobs.making import ONE_THREAD

os.environ.update(ONE_THREAD)  # before NumPy and Mesa load: measured as in a worker

import sys
import tempfile
from pathlib import Path
from typing import Final

import numpy as np

from benchmarks.rendering.sample_motion import gesturing_clip
from motion.audio import Audio
from motion.body.model import read_body
from motion.clip import MotionClip
from renderer.clip_video import Stage
from renderer.encoder import SOUND_RATE, VideoWriter
from renderer.framing import frame_clips
from renderer.look import Look, default_body

FRAMES: Final = 10_000


def main() -> None:
    """Render, and print ``name: value`` lines."""
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else FRAMES
    look = Look(framing="full_body")
    clip = gesturing_clip(frames / look.frame_rate, look.frame_rate)
    early, late = resident_mb(clip, look)
    print(f"resident_mb_after_{len(clip) // 10}: {early:.1f}")
    print(f"resident_mb_after_{len(clip)}: {late:.1f}")


def resident_mb(clip: MotionClip, look: Look) -> tuple[float, float]:
    """Return this process' memory in MB after a tenth of `clip`, and after all of it."""
    body = default_body()
    camera = frame_clips([clip], read_body(body), look)
    silence = Audio(np.zeros(round(clip.duration * SOUND_RATE), np.float32), SOUND_RATE)
    size, rate = look.size, look.frame_rate
    seen = []
    with tempfile.TemporaryDirectory() as name, Stage(body, camera, look) as stage:
        folder = Path(name)
        with (
            VideoWriter(folder / "soak.mkv", size, size, rate) as writer,
            VideoWriter(folder / "soak.mp4", size, size, rate, silence) as shown,
        ):
            for number, frame in enumerate(stage.video_frames(clip), start=1):
                writer.write(frame)
                shown.write(frame)
                if number in (len(clip) // 10, len(clip)):
                    seen.append(_resident_mb())
    return seen[0], seen[-1]


def _resident_mb() -> float:
    status = Path("/proc/self/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


if __name__ == "__main__":
    main()
