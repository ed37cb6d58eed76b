from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.evaluators.clip_views import ClipView, face_of
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.motion.random_clips import random_clip


def test_rotations_are_two_columns_of_their_matrices_and_the_face_follows() -> None:
    clip = random_clip(3)
    view = ClipView(joints=("neck",), face="expressions")
    seen = view.frames(clip)
    turn = Rotation.from_rotvec(clip.poses[2, joint_index("jaw")]).as_matrix()
    np.testing.assert_allclose(seen[2, 6:12], turn[:, :2].T.ravel(), atol=1e-6)
    np.testing.assert_array_equal(seen[:, 12:], clip.expressions)
    assert view.channels == view.floor.size == seen.shape[1]


def test_a_face_in_other_parameters_is_refused() -> None:
    clip = random_clip(3)
    with pytest.raises(InputError, match="no SMPL-X expression coefficients"):
        ClipView(face="expressions").frames(replace(clip, expressions=None))
    assert face_of(clip) == "arkit"
    assert face_of(replace(clip, arkit=None)) == "expressions"
    with pytest.raises(InputError, match="no face"):
        face_of(random_clip(3, face=False))
