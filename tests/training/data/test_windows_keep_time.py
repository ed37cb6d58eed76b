"""A click in the sound at the moment of a jump of a joint is in the jump's frame, in every window.

Files of each data set, at their own rates, go through the readers and features as in training.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import soundfile

from motion.formats.ted_npz import read_ted_npz
from tests.training.data.recordings import (
    write_beat_face,
    write_beat_motion,
    write_clicks,
    write_show,
    write_smplx,
    write_ted,
)
from training.data.feature_cache import prepare
from training.data.folders import read_takes
from training.data.take import Feature
from training.data.windows import Windows
from training.features import (
    beat_expression,
    beat_gesture,
    mel,
    show_gesture,
)

SECONDS = 24.0
MOMENTS = (0.83, 4.21, 9.07, 14.55, 19.9, 23.3)


def beat(folder: Path) -> None:
    write_beat_motion(folder / "2" / "2_scott_0_9_9.bvh", SECONDS, MOMENTS)
    write_beat_face(folder / "2" / "2_scott_0_9_9.json", SECONDS, MOMENTS)
    write_clicks(folder / "2" / "2_scott_0_9_9.wav", SECONDS, MOMENTS)


def thinned_beat(folder: Path) -> None:
    """As BEAT's baselines hold it: 15 frames a second under a header that says 120."""
    frames = round(SECONDS * 120)
    write_beat_motion(folder / "2_scott_0_9_9.bvh", SECONDS, MOMENTS, 15, promised=frames)
    write_beat_face(folder / "2_scott_0_9_9.json", SECONDS, MOMENTS)
    write_clicks(folder / "2_scott_0_9_9.wav", SECONDS, MOMENTS, rate=44100)


def beat2(folder: Path) -> None:
    write_smplx(folder / "smplxflame_30" / "2_scott_0_9_9.npz", SECONDS, MOMENTS)
    write_clicks(folder / "wave16k" / "2_scott_0_9_9.wav", SECONDS, MOMENTS)


def amass(folder: Path) -> None:
    write_smplx(folder / "anna" / "walk.npz", SECONDS, MOMENTS, rate=100)
    write_clicks(folder / "anna" / "walk.wav", SECONDS, MOMENTS, rate=48000)


def mp3_named_wav(folder: Path) -> None:
    """As what a researcher's folder really holds."""
    amass(folder)
    path = folder / "anna" / "walk.wav"
    sound, rate = soundfile.read(path)
    soundfile.write(path, sound, rate, format="MP3")


def show(folder: Path) -> None:
    clip = folder / "oliver" / "a video.mp4" / "12-00_01" / "12-00_01"
    write_show(clip.with_suffix(".npy"), SECONDS, MOMENTS)
    write_clicks(clip.with_suffix(".wav"), SECONDS, MOMENTS, rate=22050)


def ted(folder: Path) -> None:
    write_ted(folder / "train" / "talk" / "0.npz", SECONDS, MOMENTS)
    write_clicks(folder / "train" / "talk" / "0.wav", SECONDS, MOMENTS)


def ted_directions(frame_rate: float) -> Feature:
    return Feature(
        name="gesture",
        version="1",
        compute=lambda take: read_ted_npz(take.motion).directions.reshape(-1, 27),
    )


@pytest.mark.parametrize(
    ("write", "motions", "frame_rate", "frames", "stride"),
    [
        (beat, (beat_gesture, beat_expression), 15, 34, 10),
        (thinned_beat, (beat_gesture,), 15, 34, 10),
        (beat2, (show_gesture,), 30, 88, 44),
        (mp3_named_wav, (show_gesture,), 15, 34, 10),
        (show, (show_gesture,), 30, 88, 44),
        (ted, (ted_directions,), 15, 34, 10),
    ],
)
def test_click_and_jump_are_in_one_frame_of_every_window(
    tmp_path: Path,
    write: Callable[[Path], None],
    motions: tuple[Callable[[float], Feature], ...],
    frame_rate: int,
    frames: int,
    stride: int,
) -> None:
    write(tmp_path / "data")
    features = [motion(frame_rate) for motion in motions]
    prepared = prepare(
        read_takes(tmp_path / "data"),
        [*features, mel(frame_rate)],
        tmp_path / "cache",
        frame_rate=frame_rate,
    )
    assert not prepared.skipped
    windows = Windows(prepared, split=None, frames=frames, stride=stride)
    assert len(prepared.takes) == 1
    seen = set()
    for row in range(len(windows)):
        start = row * stride
        values = windows.batch(np.array([row]))
        inside = [moment for moment in MOMENTS if 2 < moment * frame_rate - start < frames - 3]
        power = values["mel"][0].sum(axis=1)
        for moment in inside:
            expected = moment * frame_rate - start
            near = slice(round(expected) - 2, round(expected) + 3)
            clicked = near.start + int(power[near].argmax())
            assert power[clicked] > 100 * np.median(power)
            assert abs(clicked - expected) <= 1
            for feature in features:
                steps = np.abs(np.diff(values[feature.name][0], axis=0)).sum(axis=1)
                jumped = near.start + int(steps[near].argmax()) + 1
                assert steps[jumped - 1] > 0.1
                assert abs(jumped - clicked) <= 1
                assert abs(jumped - expected) <= 1
            seen.add(moment)
    assert seen == set(MOMENTS)
