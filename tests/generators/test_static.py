"""Static: calm, arms down, and perfectly still."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from generators.interface import SpeechSegment
from generators.static import Static
from motion.rest_pose import REST_JOINTS
from motion.skeleton import forward_kinematics, joint_index


def test_nothing_moves(speak: Callable[..., SpeechSegment]) -> None:
    clip = Static().generate(speak("a", 3.0), seed=0, frame_rate=30)
    assert (clip.poses == clip.poses[0]).all()
    assert (clip.trans == clip.trans[0]).all()
    assert not clip.arkit.any()


def test_both_hands_hang_below_the_hips_beside_the_body(
    speak: Callable[..., SpeechSegment],
) -> None:
    clip = Static().generate(speak("a", 1.0), seed=0, frame_rate=30)
    joints, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    left, right = (joints[0, joint_index(f"{side}_wrist")] for side in ("left", "right"))
    assert left[1] < joints[0, joint_index("pelvis"), 1]
    np.testing.assert_allclose(left, right * (-1, 1, 1), atol=1e-6)
    assert 0.17 < left[0] < 0.4
