from __future__ import annotations

import numpy as np
import pytest

from analysis.metrics.pairing import paired


def test_clips_are_cut_to_the_shorter_one():
    one, other, reason = paired(np.zeros((30, 2, 3)), np.zeros((29, 2, 3)))
    assert (len(one), len(other), reason) == (29, 29, "")


def test_frames_of_different_joints_never_pair():
    with pytest.raises(ValueError, match="shapes"):
        paired(np.zeros((5, 2, 3)), np.zeros((5, 4, 3)))


def test_no_frame_is_said():
    assert paired(np.zeros((0, 2)), np.zeros((0, 2)))[2] == "a clip has no frame"
