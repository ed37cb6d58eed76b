"""Windows of takes."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from motion.errors import InputError
from motion.formats.ted_npz import read_ted_npz
from tests.training.data.recordings import (
    write_beat_take,
    write_clicks,
    write_show,
    write_smplx,
    write_ted,
)
from tests.training.takes import prepared_takes, take_named
from training.data.feature_cache import PreparedTakes, prepare
from training.data.folders import read_takes
from training.data.take import SPLITS, Feature
from training.data.windows import Windows
from training.features import beat_expression, beat_gesture, mel, show_gesture


def takes_of(*frames: int) -> PreparedTakes:
    """Return takes whose feature contains take and frame; every third is for testing."""
    takes = tuple(
        take_named(f"take{index}", split=SPLITS[index % 3]) for index in range(len(frames))
    )
    arrays = tuple(
        np.stack([np.full(count, index), np.arange(count)], axis=1).astype(np.float32)
        for index, count in enumerate(frames)
    )
    other = tuple(-array for array in arrays)
    return prepared_takes(takes, {"one": arrays, "other": other}, 15.0)


@given(st.lists(st.integers(1, 60), min_size=1, max_size=6), st.integers(1, 20), st.integers(1, 12))
def test_window_k_of_a_split_begins_at_frame_k_strides_in_all_features(
    counts: list[int], frames: int, stride: int
) -> None:
    assume(max(counts[::3]) >= frames)
    prepared = takes_of(*counts)
    windows = Windows(prepared, split="train", frames=frames, stride=stride)
    expected = [
        (take, start)
        for take, count in enumerate(counts)
        if take % 3 == 0
        for start in range(0, count - frames + 1, stride)
    ]
    assert len(windows) == len(expected)
    rows = np.arange(len(windows))
    batch = windows.batch(rows)
    for row, (take, start) in enumerate(expected):
        assert windows.take_of(row) is prepared.takes[take]
        assert (batch["one"][row, :, 0] == take).all()
        np.testing.assert_array_equal(batch["one"][row, :, 1], start + np.arange(frames))
        np.testing.assert_array_equal(batch["other"][row], -batch["one"][row])


def test_takes_that_are_all_too_short_are_refused() -> None:
    with pytest.raises(InputError, match=r"none of 1 takes for train lasts the 2\.27 s"):
        Windows(takes_of(30, 60), split="train", frames=34, stride=10)


SECONDS = 24.0
MOMENTS = (0.83, 4.21, 9.07, 14.55, 19.9, 23.3)


def beat(folder: Path) -> None:
    write_beat_take(folder / "2", SECONDS, MOMENTS)


def beat2(folder: Path) -> None:
    write_smplx(folder / "smplxflame_30" / "2_scott_0_9_9.npz", SECONDS, MOMENTS)
    write_clicks(folder / "wave16k" / "2_scott_0_9_9.wav", SECONDS, MOMENTS)


def amass(folder: Path) -> None:
    write_smplx(folder / "anna" / "walk.npz", SECONDS, MOMENTS, rate=100)
    write_clicks(folder / "anna" / "walk.wav", SECONDS, MOMENTS, rate=48000)


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
        (beat2, (show_gesture,), 30, 88, 44),
        (amass, (show_gesture,), 15, 34, 10),
        (show, (show_gesture,), 30, 88, 44),
        (ted, (ted_directions,), 15, 34, 10),
    ],
)
def test_sound_and_motion_stay_aligned_in_every_window(
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
    (take,) = prepared.takes
    windows = Windows(prepared, split=take.split, frames=frames, stride=stride)
    seen = set()
    for row in range(len(windows)):
        start = row * stride
        values = windows.batch(np.array([row]))
        inside = [moment for moment in MOMENTS if 2 < moment * frame_rate - start < frames - 3]
        power = values["mel"][0].sum(axis=1)
        for moment in inside:
            expected = moment * frame_rate - start
            around = slice(round(expected) - 2, round(expected) + 3)
            clicked = around.start + int(power[around].argmax())
            assert power[clicked] > 100 * np.median(power)
            assert abs(clicked - expected) <= 1
            for feature in features:
                steps = np.abs(np.diff(values[feature.name][0], axis=0)).sum(axis=1)
                jumped = around.start + int(steps[around].argmax()) + 1
                assert steps[jumped - 1] > 0.1
                assert abs(jumped - clicked) <= 1
                assert abs(jumped - expected) <= 1
            seen.add(moment)
    assert seen == set(MOMENTS)
