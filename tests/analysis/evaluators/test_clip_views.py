from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.evaluators.clip_views import ClipView, Face, face_of
from analysis.metrics.kinematics import GESTURE_JOINTS
from motion.errors import InputError
from motion.skeleton import joint_index
from tests.motion.random_clips import random_clip


def test_a_rotation_is_the_first_two_columns_of_its_matrix() -> None:
    clip = random_clip(3)
    seen = ClipView(joints=("neck", "jaw")).frames(clip)
    turn = Rotation.from_rotvec(clip.poses[2, joint_index("jaw")]).as_matrix()
    np.testing.assert_allclose(seen[2, 6:9], turn[:, 0], atol=1e-6)
    np.testing.assert_allclose(seen[2, 9:12], turn[:, 1], atol=1e-6)


@pytest.mark.parametrize("face", ["arkit", "expressions"])
def test_gesture_and_face_are_concatenated(face: Face) -> None:
    clip = random_clip(3)
    view = ClipView(joints=GESTURE_JOINTS, face=face)
    gesture, expression = ClipView(joints=GESTURE_JOINTS), ClipView(face=face)
    assert view.channels == gesture.channels + expression.channels == view.floor.size
    np.testing.assert_array_equal(
        view.frames(clip), np.hstack([gesture.frames(clip), expression.frames(clip)])
    )


def test_a_face_in_other_parameters_is_refused() -> None:
    clip = random_clip(3)
    with pytest.raises(InputError, match="no SMPL-X expression coefficients"):
        ClipView(face="expressions").frames(replace(clip, expressions=None))
    assert face_of(clip) == "arkit"
    assert face_of(replace(clip, arkit=None)) == "expressions"
    with pytest.raises(InputError, match="no face"):
        face_of(random_clip(3, face=False))
