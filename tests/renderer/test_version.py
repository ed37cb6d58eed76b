"""Videos that look or sound different must have another version, by which they are cached.

After an intended change, raise the version in `renderer.look` and update the numbers here.
"""

from dataclasses import replace
from fractions import Fraction
from io import BytesIO
from pathlib import Path

import av
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from motion.arrays import Floats, Floats32
from renderer.figures.sheet import draw_cell, glance_at
from renderer.jobs.doing import Stages, do_job
from renderer.look import CELL_VERSION, COPY_VERSION, RENDERER_VERSION, Look, default_body
from renderer.stream_copy import copy_video
from renderer.video_jobs import ClipJob, DubJob
from tests.renderer.conftest import SECONDS
from tests.renderer.jobs.sample_jobs import pair_of
from tests.support.encoded import pictures_of, sound_of
from tests.support.fingerprint import fingerprint

BLOCK = 16
"""Pixels over which colours are averaged, so that rounding does not matter."""

BODY = {"3": [0.64027, 0.00024, 0.0906]}
VIDEOS = {"3": [-0.33847, -0.01861, 1.16539, -0.00989, -0.55042, -0.08854]}
COPY = {"1": [-0.33847, -0.01861, -0.52741]}
CELL = {"1": [-0.99725]}


@pytest.fixture(scope="module")
def videos(tmp_path_factory: pytest.TempPathFactory, job: ClipJob) -> Path:
    """Return a folder with a clip, a pair of it, and the clip with another part of the speech."""
    folder = tmp_path_factory.mktemp("videos")
    video, dubbed = folder / "clip.mp4", folder / "dubbed.mp4"
    clip = replace(job, frames=folder / "clip.mkv", video=video)
    with Stages() as stages:
        dub = DubJob(
            name="dubbed", picture=video, speech=job.speech, start=0.5, end=0.5 + SECONDS,
            seconds=SECONDS, video=dubbed,
        )  # fmt: skip
        outcomes = [do_job(each, stages) for each in (clip, pair_of(clip, "pair"), dub)]
    assert [outcome.error for outcome in outcomes] == [None] * 3
    return folder


def moments(video: Path) -> Floats:
    """Return the time and duration of each packet, in seconds."""
    with av.open(str(video)) as container:
        return np.array(
            [
                (float(packet.pts * packet.time_base), float(packet.duration * packet.time_base))
                for packet in container.demux()
                if packet.pts is not None and packet.duration is not None
            ]
        )


def seen_and_heard(video: Path) -> list[Floats | Floats32]:
    return [blocks(pictures_of(video)), sound_of(video)]


def blocks(pictures: NDArray[np.uint8]) -> Floats:
    """Return mean colours of square blocks, in [0, 1]."""
    height, width = (side // BLOCK for side in pictures.shape[1:3])
    cut = pictures[:, : height * BLOCK, : width * BLOCK]
    split = cut.reshape(len(cut), height, BLOCK, width, BLOCK, -1)
    return np.asarray(split.mean(axis=(2, 4)) / 255)


def test_changed_videos_require_a_new_version(videos: Path) -> None:
    result = [
        values
        for name in ("clip", "pair", "dubbed")
        for values in seen_and_heard(videos / f"{name}.mp4")
    ]
    assert fingerprint(*result) == pytest.approx(VIDEOS[RENDERER_VERSION], abs=1e-3)


def test_the_text_form_of_a_look_is_stable() -> None:
    assert repr(Look()) == (
        "Look(size=720, frame_rate=30.0, framing='upper_body', avatar='alex', "
        "expression_matrix=None)"
    )


def test_another_body_makes_other_videos() -> None:
    with np.load(default_body(), allow_pickle=False) as body:
        result = [body[name] for name in ("v_template", "shapedirs", "weights")]
    assert fingerprint(*result) == pytest.approx(BODY[RENDERER_VERSION], abs=1e-5)


def test_changed_copies_require_a_new_version(videos: Path) -> None:
    copy_video(videos / "clip.mp4", videos / "copy.mp4", lasts=Fraction(1), sound=True)
    result = [*seen_and_heard(videos / "copy.mp4"), moments(videos / "copy.mp4")]
    assert fingerprint(*result) == pytest.approx(COPY[COPY_VERSION], abs=1e-3)


def test_changed_sheet_cells_require_a_new_version(videos: Path) -> None:
    cell = draw_cell(glance_at(videos / "clip.mp4"))
    picture = np.asarray(Image.open(BytesIO(cell)).convert("RGB"))
    assert fingerprint(blocks(picture[None])) == pytest.approx(CELL[CELL_VERSION], abs=1e-3)
