"""Jobs for tests of local and cluster workers."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip
from renderer.look import Look
from renderer.video_jobs import ClipJob


@pytest.fixture
def clip_job(job: ClipJob, tmp_path: Path) -> ClipJob:
    frames, video = tmp_path / "clip.mkv", tmp_path / "clip.mp4"
    return replace(job, look=Look(size=64), frames=frames, video=video)


@pytest.fixture
def long_job(clip_job: ClipJob, clip: MotionClip, tmp_path: Path) -> ClipJob:
    """Return a job that takes long enough to be interrupted."""
    seconds = 4
    write_clip(tmp_path / "long.npz", clip.frames(np.arange(seconds * 30) % len(clip)))
    write_wav(tmp_path / "long.wav", Audio(np.zeros(seconds * 16000, np.float32), 16000))
    return replace(
        clip_job,
        name="long",
        motion=tmp_path / "long.npz",
        speech=tmp_path / "long.wav",
        end=float(seconds),
        frames=tmp_path / "long" / "long.mkv",
        video=tmp_path / "long" / "long.mp4",
    )
