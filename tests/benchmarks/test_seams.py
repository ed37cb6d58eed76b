"""Seams are found where windows of motion do not join smoothly, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.seams import Windows, seam_acceleration, seams_of_clip, windows_of
from motion.errors import InputError
from tests.motion.random_clips import clip_of

WINDOWS = Windows(frames=34, overlap=4, frame_rate=15)


def wandering(frames: int = 600, seed: int = 0) -> np.ndarray:
    """Return points with uniform accelerations, (T, 5, 3)."""
    steps = np.random.default_rng(seed).standard_normal((frames, 5, 3))
    return np.cumsum(np.cumsum(steps, axis=0), axis=0)


def ratio(values: np.ndarray) -> float:
    return seam_acceleration(values, WINDOWS, of="points").value


def test_motion_without_seams_has_a_ratio_of_one() -> None:
    result = seam_acceleration(wandering(), WINDOWS, of="points")
    assert result.value == pytest.approx(1, abs=0.1)
    assert result.interval is not None
    assert result.interval[0] < 1 < result.interval[1]
    assert result.n == 19


@pytest.mark.parametrize(
    ("frame", "at_seam"),
    [(0, True), (2, True), (4, True), (-2, False), (7, False), (15, False)],
)
def test_jumps_are_detected_at_seams_only(frame: int, at_seam: bool) -> None:
    """Frame 0 is the first shared one, and 4 the first that is shared no more."""
    values = wandering()
    for border in range(30, 600, 30):
        values[border + frame :] += 5
    assert ratio(values) > 1.8 if at_seam else ratio(values) < 0.9


def test_a_clip_records_where_its_windows_begin() -> None:
    rng = np.random.default_rng(1)
    turns = np.cumsum(0.01 * rng.standard_normal((150, 55, 3)), axis=0)
    clip = clip_of(np.repeat(turns, 2, axis=0), arkit=rng.random((300, 52)))
    with pytest.raises(InputError, match="does not say where"):
        list(seams_of_clip(clip))
    stated = clip.with_provenance(window_frames="34", window_overlap="4", window_frame_rate="15")
    assert windows_of(stated) == WINDOWS
    result = list(seams_of_clip(stated))
    names = [seam.name.partition("(")[2] for seam in result]
    assert names == ["arms and head)", "fingers)", "face)"]
    assert all(0.7 < seam.value < 1.4 for seam in result)
