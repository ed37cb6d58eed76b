from __future__ import annotations

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip, arkit_index
from motion.skeleton import REST_JOINTS, joint_index


def test_rest_joints_are_those_of_the_default_body(body: BodyModel) -> None:
    np.testing.assert_allclose(body.joints(np.zeros(0)), REST_JOINTS, atol=6e-5)


def _mouth_opening(body: BodyModel, jaw: float, action: float) -> float:
    """Return the height of the lips, in metres, with the jaw joint (radians) and jawOpen set."""
    poses, arkit = np.zeros((1, 55, 3), np.float32), np.zeros((1, 52), np.float32)
    poses[0, joint_index("jaw"), 0] = jaw
    arkit[0, arkit_index("jawOpen")] = action
    clip = MotionClip(poses=poses, trans=np.zeros((1, 3), np.float32), frame_rate=30, arkit=arkit)
    lips = body.surface["material"] == list(body.surface["material_names"]).index("lips")
    return float(np.ptp(body.vertices(clip)[0, lips, 1]))


def test_jaw_joint_and_arkit_do_not_open_the_mouth_twice(body: BodyModel) -> None:
    by_joint, by_action = _mouth_opening(body, 0.14, 0.0), _mouth_opening(body, 0.0, 1.0)
    both = _mouth_opening(body, 0.14, 0.5)
    wide = _mouth_opening(body, 0.14, 1.0)
    assert both == pytest.approx(by_joint, abs=2e-3)
    assert by_joint + 5e-3 < wide < by_action + 4e-3
    assert _mouth_opening(body, -0.05, 1.0) <= by_action
