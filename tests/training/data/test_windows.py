"""Windows of takes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from motion.errors import InputError
from tests.training.takes import prepared_takes, take_named
from training.data.feature_cache import PreparedTakes
from training.data.take import SPLITS
from training.data.windows import Windows


def takes_of(*frames: int) -> PreparedTakes:
    """Return takes whose feature tells take and frame; every third is for testing."""
    takes = tuple(
        take_named(f"take{index}", split=SPLITS[index % 3]) for index in range(len(frames))
    )
    arrays = tuple(
        np.stack([np.full(count, index), np.arange(count)], axis=1).astype(np.float32)
        for index, count in enumerate(frames)
    )
    other = tuple(-array for array in arrays)
    return prepared_takes(takes, {"one": arrays, "other": other}, 15.0)


@given(
    st.lists(st.integers(1, 60), min_size=1, max_size=6),
    st.integers(1, 20),
    st.integers(1, 12),
)
def test_window_k_of_a_take_begins_at_frame_k_strides_in_all_features(
    counts: list[int], frames: int, stride: int
) -> None:
    prepared = takes_of(*counts)
    if max(counts) < frames:
        with pytest.raises(InputError, match="lasts the"):
            Windows(prepared, split=None, frames=frames, stride=stride)
        return
    windows = Windows(prepared, split=None, frames=frames, stride=stride)
    expected = [
        (take, start)
        for take, count in enumerate(counts)
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


def test_windows_are_of_one_split_and_too_short_takes_are_told() -> None:
    prepared = takes_of(50, 50, 50, 5, 60)
    windows = Windows(prepared, split="train", frames=34, stride=10)
    assert {windows.take_of(row).name for row in range(len(windows))} == {"take0"}
    assert [take.name for take in windows.too_short] == ["take3"]
    assert windows.frame_rate == 15


@pytest.mark.parametrize("row", [-1, 11])
def test_rows_that_are_not_there_are_refused(row: int) -> None:
    windows = Windows(takes_of(60), split=None, frames=10, stride=5)
    with pytest.raises(IndexError, match="no window"):
        windows.batch(np.array([row]))


def test_a_split_without_takes_says_so() -> None:
    with pytest.raises(InputError, match=r"none of 0 takes for validation lasts the 2\.27 s"):
        Windows(takes_of(60), split="validation", frames=34, stride=10)
