"""Motion of TED Gesture as plain arrays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats.ted_npz import BONES, read_ted_npz

JOINTS = np.random.default_rng(1).uniform(-1, 1, (4, 10, 3))


def directions(joints: np.ndarray) -> np.ndarray:
    bones = np.stack([joints[:, child] - joints[:, parent] for parent, child in BONES], axis=1)
    return np.asarray(bones / np.linalg.norm(bones, axis=2, keepdims=True))


def test_joints_and_directions_tell_the_same(tmp_path: Path) -> None:
    wanted = directions(JOINTS)
    np.savez(tmp_path / "joints.npz", joints=JOINTS * 7)
    np.savez(tmp_path / "flat.npz", directions=wanted.reshape(4, 27), frame_rate=25)
    np.savez(tmp_path / "deep.npz", directions=wanted)
    for name in ("joints", "flat", "deep"):
        np.testing.assert_allclose(
            read_ted_npz(tmp_path / f"{name}.npz").directions, wanted, atol=1e-6
        )
    assert read_ted_npz(tmp_path / "joints.npz").frame_rate == 15
    assert read_ted_npz(tmp_path / "flat.npz").frame_rate == 25


def without_bone() -> np.ndarray:
    joints = JOINTS.copy()
    joints[2, 6] = joints[2, 5]
    return joints


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"poses": JOINTS}, "holds no motion of TED Gesture"),
        ({"joints": JOINTS[:0]}, r"shape \(0, 10, 3\)"),
        ({"joints": JOINTS[:, :9]}, r"Give numbers of shape \(frames, 30\) or \(frames, 10, 3\)"),
        ({"joints": np.full((2, 10, 3), "a")}, "type <U1"),
        ({"joints": JOINTS * np.nan}, "frame 0 holds no number"),
        ({"joints": without_bone()}, "bone 5 has no length in frame 2"),
        ({"directions": directions(JOINTS) - 0.5}, "a direction has length"),
        ({"joints": JOINTS, "frame_rate": 0}, "frame rate 0"),
        ({"joints": np.array([None] * 10)}, "cannot be read as plain arrays"),
    ],
)
def test_other_arrays_are_refused_with_the_files_name(
    tmp_path: Path, arrays: dict[str, Any], message: str
) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=rf"a\.npz: .*{message}"):
        read_ted_npz(tmp_path / "a.npz")


def test_other_files_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(b"no archive")
    with pytest.raises(InputError, match="cannot be read as plain arrays"):
        read_ted_npz(tmp_path / "a.npz")
