from __future__ import annotations

from pathlib import Path

import numpy as np

from renderer.look import BACKGROUND
from tools.avatars.sample_poses import SAMPLE_POSES
from tools.avatars.sheet import COLUMNS, avatar_sheet


def test_a_sheet_shows_the_body_in_every_pose(body_path: Path) -> None:
    size = 64
    sheet = np.asarray(avatar_sheet(body_path, "upper body", size=size)).astype(int)
    rows = -(-len(SAMPLE_POSES) // COLUMNS)
    assert sheet.shape == (rows * size, COLUMNS * size, 3)
    tiles = sheet.reshape(rows, size, COLUMNS, size, 3).swapaxes(1, 2).reshape(-1, size, size, 3)
    shown = np.abs(tiles - BACKGROUND).max(axis=3) > 20
    assert shown[: len(SAMPLE_POSES)].mean(axis=(1, 2)).min() > 0.1
    assert len(np.unique(tiles, axis=0)) >= len(SAMPLE_POSES) - 3  # three move only the face
