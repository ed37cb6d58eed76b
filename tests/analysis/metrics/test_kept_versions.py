"""What metrics keep is used for as long as its version is the same, which must be true."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.metrics import joint_motion, kept_onsets
from motion.clip import MotionClip
from motion.speech_onsets import speech_onsets
from tests.fingerprint import fingerprint
from tests.generators.conftest import syllables

# Where a change is wanted, raise the version in the module and write its new numbers here.
JOINTS = {"1": [-0.7307, 0.09075]}
ONSETS = {"1": [-3.59122]}


def test_joints_that_lie_elsewhere_have_another_version() -> None:
    waves = np.sin(np.arange(40)[:, None, None] / 9 + np.arange(165).reshape(55, 3)) / 5
    clip = MotionClip(poses=waves, trans=waves[:, 0], frame_rate=25)
    found = joint_motion.joint_motion(clip, 30)
    assert fingerprint(found.relative, found.pelvis) == pytest.approx(
        JOINTS[joint_motion.VERSION], abs=1e-5
    )


def test_onsets_that_are_found_elsewhere_have_another_version() -> None:
    onsets = speech_onsets(syllables(6.0, 1))
    assert fingerprint(onsets) == pytest.approx(ONSETS[kept_onsets.VERSION], abs=1e-4)
