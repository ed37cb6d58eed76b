from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from motion.formats.bvh import BvhMotion, read_bvh
from motion.formats.first_frame import settle_first_frame
from tests.motion.formats.bvh_text import CHAIN, bvh_text, columns_of, write_bvh


def chain(tmp_path: Path, rows: np.ndarray) -> BvhMotion:
    return read_bvh(write_bvh(tmp_path / "a.bvh", bvh_text(CHAIN, rows)))


def test_pose_left_over_in_the_first_frame_settles(tmp_path: Path) -> None:
    rows = np.stack([columns_of(CHAIN, {"knee": (0, 10 + k, 0)}) for k in range(4)])
    rows[0] += columns_of(CHAIN, {"hip": (20, 0, 0)})
    motion = settle_first_frame(chain(tmp_path, rows))
    rows[0] -= columns_of(CHAIN, {"hip": (20, 0, 0)})
    np.testing.assert_allclose(motion.values, rows)
    assert "1 joints" in motion.notes[0]


@pytest.mark.parametrize("frames", [1, 2, 4])
def test_motion_without_such_a_pose_stays_as_it_is(tmp_path: Path, frames: int) -> None:
    rows = np.stack([columns_of(CHAIN, {"knee": (0, 10 + k, 0)}) for k in range(frames)])
    motion = chain(tmp_path, rows)
    assert settle_first_frame(motion) is motion


def _bending(**first: tuple[float, float, float]) -> np.ndarray:
    """Return four rows of a slowly bending leg; the first has the pose `first` instead."""
    rows = [columns_of(CHAIN, {"hip": (5, k, 0), "knee": (0, 10 + 5 * k, 0)}) for k in range(4)]
    return np.stack([columns_of(CHAIN, first), *rows[1:]])


def test_calibration_pose_in_the_first_row_is_no_motion(tmp_path: Path) -> None:
    rows = _bending(hip=(170, 0, 0), knee=(0, 0, 90))
    motion = settle_first_frame(chain(tmp_path, rows))
    np.testing.assert_allclose(motion.values, rows[[1, 1, 2, 3]])
    np.testing.assert_allclose(motion.calibration, rows[0])
    assert "first frame is a pose apart" in motion.notes[0]


def test_a_glitch_later_on_does_not_keep_the_calibration_pose(tmp_path: Path) -> None:
    angles = 20 * np.sin(np.arange(90) / 9)
    rows = np.stack([columns_of(CHAIN, {"knee": (0, angle, 0)}) for angle in angles])
    rows[0] = columns_of(CHAIN, {"hip": (170, 0, 0), "knee": (0, 0, 90)})
    rows[50] = columns_of(CHAIN, {"hip": (170, 0, 0), "knee": (0, 90, 0)})
    motion = settle_first_frame(chain(tmp_path, rows))
    np.testing.assert_allclose(motion.calibration, rows[0])
    np.testing.assert_allclose(motion.values, rows[[1, *range(1, 90)]])


def test_quick_start_of_a_motion_is_kept(tmp_path: Path) -> None:
    motion = chain(tmp_path, _bending(hip=(80, 0, 0), knee=(0, 0, 60)))
    assert settle_first_frame(motion) is motion


def test_jumps_all_along_are_no_calibration(tmp_path: Path) -> None:
    rows = _bending(hip=(170, 0, 0), knee=(0, 0, 90))
    rows[3] = columns_of(CHAIN, {"hip": (-170, 0, 90), "knee": (0, 90, 0)})
    motion = chain(tmp_path, rows)
    assert settle_first_frame(motion) is motion


def test_real_recording_cut_to_its_upper_body_does_not_jump(shared_data: Path) -> None:
    motion = read_bvh(shared_data / "2_scott_0_1_1.bvh", frame_rate=15)
    settled = settle_first_frame(motion)
    assert not settled.values[:, settled.columns(0)].any()
    assert "13 joints" in settled.notes[-1]
    assert settled.calibration is None


def test_real_recording_begins_after_its_calibration(shared_data: Path) -> None:
    motion = read_bvh(shared_data / "aitviewer_sample.bvh")
    settled = settle_first_frame(motion)
    np.testing.assert_array_equal(settled.values[0], motion.values[1])
    np.testing.assert_array_equal(settled.calibration, motion.values[0])
