"""What the renderer's tests share: the default body, a clip, its speech."""

from pathlib import Path

import numpy as np
import pytest

from benchmarks.rendering.sample_motion import gesturing_clip
from motion.audio import write_wav
from motion.body.model import BodyModel, read_body
from motion.clip import MotionClip, arkit_index
from motion.formats import write_clip
from renderer.framing import Camera, frame_clips
from renderer.look import Look, default_body
from renderer.video_jobs import ClipJob
from tests.motion.random_clips import clip_of
from tests.support.sounds import tone

SECONDS = 0.8
"""Length of the test clip; no whole number of AAC frames."""

SMALL_LOOK = Look(size=160)


@pytest.fixture(scope="session")
def body() -> BodyModel:
    return read_body(default_body())


@pytest.fixture(scope="session")
def clip() -> MotionClip:
    """Return a short clip that gestures, speaks and smiles."""
    plain = gesturing_clip(SECONDS, 30)
    arkit = np.zeros((len(plain), 52))
    arkit[:, arkit_index("mouthSmileLeft")] = np.linspace(0, 1, len(plain))
    return clip_of(plain.poses, plain.trans, arkit=arkit)


@pytest.fixture(scope="session")
def camera(clip: MotionClip, body: BodyModel) -> Camera:
    return frame_clips([clip], body, SMALL_LOOK)


@pytest.fixture(scope="session")
def inputs(tmp_path_factory: pytest.TempPathFactory, clip: MotionClip) -> Path:
    """Return a folder with ``clip.npz`` and ``speech.wav``, which hums one second longer."""
    folder = tmp_path_factory.mktemp("inputs")
    write_clip(folder / "clip.npz", clip)
    write_wav(folder / "speech.wav", tone(SECONDS + 1, 220, loud=0.2))
    return folder


@pytest.fixture(scope="session")
def job(inputs: Path, camera: Camera) -> ClipJob:
    """Return a job of the clip with the beginning of its speech, which writes no file yet."""
    return ClipJob(
        name="clip",
        motion=inputs / "clip.npz",
        speech=inputs / "speech.wav",
        start=0.0,
        end=SECONDS,
        freeze=(),
        body=default_body(),
        camera=camera,
        look=SMALL_LOOK,
        frames=None,
        video=None,
    )
