"""A whole body as continuous numbers."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from motion.clip import MotionClip
from motion.placement import place
from training.spaces.smplx_6d import WIDTH, smplx_6d_clip, smplx_6d_values


def _clip() -> MotionClip:
    random = np.random.default_rng(5)
    poses = 0.4 * random.standard_normal((6, 55, 3))
    poses[:, 0] = 0
    clip = MotionClip(
        poses=poses.astype(np.float32), trans=np.zeros((6, 3), np.float32), frame_rate=30
    )
    return place(clip)[0]


def _turns(clip: MotionClip) -> Rotation:
    return Rotation.from_rotvec(clip.poses.reshape(-1, 3))


def test_a_clip_comes_back_from_its_values() -> None:
    clip = _clip()
    values = smplx_6d_values(clip)
    back = smplx_6d_clip(values, 30)
    assert values.shape == (6, WIDTH)
    assert (_turns(clip).inv() * _turns(back)).magnitude().max() < 1e-5
    assert back.trans == pytest.approx(clip.trans, abs=1e-5)


def test_values_that_are_no_rotation_give_the_nearest_whose_first_row_is_theirs() -> None:
    clip = _clip()
    values = smplx_6d_values(clip)
    stretched = values.copy()
    rows = stretched[:, :330].reshape(6, 55, 2, 3)
    rows[..., 1, :] += 0.3 * rows[..., 0, :]
    rows *= 1.7
    back = smplx_6d_clip(stretched, 30)
    assert (_turns(clip).inv() * _turns(back)).magnitude().max() < 1e-5


def test_the_first_two_rows_of_a_rotation_matrix_are_kept() -> None:
    clip = _clip()
    matrix = Rotation.from_rotvec(clip.poses[2, 16]).as_matrix()
    assert smplx_6d_values(clip)[2, 6 * 16 : 6 * 17] == pytest.approx(matrix[:2].ravel())
