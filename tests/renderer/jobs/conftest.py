"""Jobs for tests of local and cluster workers."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.audio import Audio, write_wav
from motion.clip import MotionClip
from motion.formats import write_clip
from renderer.framing import Camera
from renderer.jobs.job import ClipJob
from renderer.look import Look
from tests.renderer.conftest import SECONDS


@pytest.fixture
def clip_job(inputs: Path, body_path: Path, camera: Camera, tmp_path: Path) -> ClipJob:
    return ClipJob(
        name="clip",
        motion=inputs / "clip.npz",
        speech=inputs / "speech.wav",
        start=0.0,
        end=SECONDS,
        freeze=(),
        body=body_path,
        camera=camera,
        look=Look(size=64),
        frames=tmp_path / "clip.mkv",
        video=tmp_path / "clip.mp4",
    )


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
