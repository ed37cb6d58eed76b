from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from motion.clip import MotionClip
from motion.errors import InputError


def clip(frames: int = 4, **changes: Any) -> MotionClip:
    fields: dict[str, Any] = {
        "poses": np.zeros((frames, 55, 3)),
        "trans": np.zeros((frames, 3)),
        "frame_rate": 30,
    }
    return MotionClip(**{**fields, **changes})


def test_a_clip_keeps_read_only_float32_copies() -> None:
    poses = np.zeros((4, 55, 3))
    made = clip(poses=poses)
    poses[0] = 1
    assert made.poses.dtype == np.float32
    assert not made.poses.any()
    with pytest.raises(ValueError, match="read-only"):
        made.poses[0] = 1


def test_duration_counts_each_frame_as_one_interval() -> None:
    assert clip(frames=45, frame_rate=30).duration == 1.5


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"poses": np.zeros((4, 54, 3))}, "poses has shape"),
        ({"trans": np.zeros((3, 3))}, "trans has shape"),
        ({"expressions": np.zeros((4, 10))}, "expressions has shape"),
        ({"arkit": np.zeros((4, 51))}, "arkit has shape"),
        ({"arkit": np.full((4, 52), 100.0)}, "arkit weights"),
        ({"poses": np.full((4, 55, 3), np.nan)}, r"poses holds .* index \(0, 0, 0\)"),
        ({"trans": np.full((4, 3), np.inf)}, "trans holds"),
        ({"trans": np.full((4, 3), 1e300)}, r"trans holds 1e\+300 at index \(0, 0\)"),
        ({"frame_rate": 0}, "frame rate"),
        ({"frame_rate": 1e-6}, "frame rate"),
        ({"frame_rate": 1001}, "frame rate"),
        ({"frame_rate": float("nan")}, "frame rate"),
        ({"gender": "robot"}, "gender"),
    ],
)
def test_a_clip_refuses_what_it_cannot_be(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        clip(**changes)


def test_a_clip_without_frames_is_refused() -> None:
    with pytest.raises(InputError, match="no frame"):
        clip(frames=0, arkit=np.zeros((0, 52)))


def test_picking_frames_keeps_all_channels_together() -> None:
    numbers = np.arange(6, dtype=float)
    made = clip(
        frames=6,
        trans=np.repeat(numbers[:, None], 3, axis=1),
        arkit=np.repeat(numbers[:, None] / 10, 52, axis=1),
        expressions=np.repeat(numbers[:, None], 100, axis=1),
    )
    picked = made.frames(slice(2, 5))
    assert picked.arkit is not None
    assert picked.expressions is not None
    np.testing.assert_allclose(picked.trans[:, 0], [2, 3, 4])
    np.testing.assert_allclose(picked.arkit[:, 0], [0.2, 0.3, 0.4], rtol=1e-6)
    np.testing.assert_allclose(picked.expressions[:, 0], [2, 3, 4])


def test_provenance_grows_and_cannot_be_changed_in_place() -> None:
    made = clip(provenance={"generator": "static"}).with_provenance(seed="3")
    assert made.provenance == {"generator": "static", "seed": "3"}
    with pytest.raises(TypeError):
        made.provenance["seed"] = "4"  # type: ignore[index]
