from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.smplx_rows import read_rows, read_show_npz
from motion.skeleton import JOINT_NAMES, joint_index


def assert_columns(clip: MotionClip, first_column: dict[str, int]) -> None:
    for name, column in first_column.items():
        expected = np.arange(column, column + 3) / 1000
        np.testing.assert_allclose(clip.poses[1, joint_index(name)], expected, err_msg=name)


def test_every_channel_lands_on_its_joint(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.tile(np.arange(265) / 1000, (3, 1)))
    clip = read_rows(tmp_path / "a.npy")
    places = {"jaw": 0, "left_eye": 3, "pelvis": 9, "left_hip": 12, "right_wrist": 72}
    assert_columns(clip, places | {"left_index1": 75, "left_thumb3": 117, "right_thumb3": 162})
    assert len(np.unique(clip.poses)) == 3 * len(JOINT_NAMES)
    assert clip.expressions is not None
    np.testing.assert_allclose(clip.expressions[2], np.arange(165, 265) / 1000)
    assert clip.frame_rate == 30
    assert not clip.trans.any()


def test_every_channel_of_motion_x_lands_on_its_joint(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.tile(np.arange(322) / 1000, (3, 1)))
    clip = read_rows(tmp_path / "a.npy")
    places = {"pelvis": 0, "left_hip": 3, "right_wrist": 63, "left_index1": 66}
    assert_columns(clip, places | {"right_thumb3": 153, "jaw": 156})
    assert not clip.poses[:, joint_index("left_eye")].any()
    assert clip.expressions is not None
    np.testing.assert_allclose(clip.expressions[2, :50], np.arange(159, 209) / 1000)
    np.testing.assert_allclose(clip.trans[2], np.arange(309, 312) / 1000)
    np.testing.assert_allclose(clip.betas, np.arange(312, 322) / 1000)
    assert clip.provenance["format"] == "motion-x"


@pytest.mark.parametrize(
    ("rows", "complaint"),
    [
        (np.zeros((3, 264)), r"shape \(3, 264\)"),
        (np.zeros(265), r"shape \(265,\)"),
        (np.full((3, 265), np.inf), "not a number"),
        (np.full((3, 265), "x"), "type <U1"),
        (np.array([None]), "plain array"),
    ],
)
def test_other_arrays_than_talkshow_motion_are_refused_by_name(
    tmp_path: Path, rows: np.ndarray, complaint: str
) -> None:
    np.save(tmp_path / "bad.npy", rows, allow_pickle=True)
    with pytest.raises(InputError, match=complaint) as caught:
        read_rows(tmp_path / "bad.npy")
    assert "bad.npy" in caught.value.where


def test_damaged_missing_and_endless_files_are_refused_by_name(tmp_path: Path) -> None:
    (tmp_path / "bad.npy").write_bytes(b"\x93NUMPY")
    for frames in (10**12, 10**30):
        with (tmp_path / f"{frames}.npy").open("wb") as file:
            header = {"descr": "<f4", "fortran_order": False, "shape": (frames, 265)}
            np.lib.format.write_array_header_1_0(file, header)
    for name in ("bad.npy", "gone.npy", f"{10**12}.npy", f"{10**30}.npy"):
        with pytest.raises(InputError, match=rf"{name}: .* plain array"):
            read_rows(tmp_path / name)


def shows_arrays(frames: int = 3) -> dict[str, Any]:
    """Return SHOW's arrays of a motion with distinct columns."""
    widths = {
        **dict.fromkeys(("jaw_pose", "leye_pose", "reye_pose", "global_orient"), 3),
        "body_pose_axis": 63,
        "left_hand_pose": 45,
        "right_hand_pose": 45,
        "expression": 100,
    }
    first = 0
    arrays: dict[str, Any] = {}
    for name, width in widths.items():
        arrays[name] = np.tile(np.arange(first, first + width) / 1000, (frames, 1))
        first += width
    return arrays


def test_shows_own_arrays_make_the_same_motion(tmp_path: Path) -> None:
    arrays = shows_arrays()
    arrays["body_pose_axis"] = arrays["body_pose_axis"].reshape(3, 21, 3)
    np.savez(tmp_path / "a.npz", **arrays, betas=np.zeros(300))
    np.save(tmp_path / "a.npy", np.tile(np.arange(265) / 1000, (3, 1)))
    result, expected = read_show_npz(tmp_path / "a.npz"), read_rows(tmp_path / "a.npy")
    np.testing.assert_array_equal(result.poses, expected.poses)
    np.testing.assert_array_equal(result.expressions, expected.expressions)
    assert result.frame_rate == 30


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"jaw_pose": None}, "there is no array 'jaw_pose'"),
        ({"left_hand_pose": np.zeros((3, 12))}, "expand the principal components of hands"),
        ({"expression": np.zeros((2, 100))}, "equal length"),
        ({"expression": np.full((3, 100), np.nan)}, "not a number"),
        ({"expression": np.full((3, 100), "a")}, "no numbers in the array 'expression'"),
        ({"expression": np.array([None] * 3)}, "cannot be read as plain arrays"),
    ],
)
def test_shows_arrays_that_make_no_motion_are_refused(
    tmp_path: Path, changed: dict[str, Any], message: str
) -> None:
    arrays = {**shows_arrays(), **changed}
    kept = {name: array for name, array in arrays.items() if array is not None}
    np.savez(tmp_path / "a.npz", **kept)
    with pytest.raises(InputError, match=rf"a\.npz: .*{message}"):
        read_show_npz(tmp_path / "a.npz")
