from __future__ import annotations

import numpy as np

from analysis.measurement.joint_motion import joint_motion
from analysis.metrics.joint_positions import common_frame_rate, select


def test_clips_are_compared_at_the_slowest_rate_up_to_thirty():
    assert common_frame_rate({15.0, 30.0}) == 15.0
    assert common_frame_rate({60.0, 120.0}) == 30.0
    assert common_frame_rate([25.0]) == 25.0


def test_joints_are_selected_by_name_in_the_order_asked(waving):
    positions = joint_motion(waving(), 30.0).relative
    left, right = (select(positions, [name])[:, 0] for name in ("left_wrist", "right_wrist"))
    both = select(positions, ["right_wrist", "left_wrist"])
    np.testing.assert_array_equal(both[:, 0], right)
    np.testing.assert_array_equal(both[:, 1], left)
    assert left[0, 0] > 0 > right[0, 0]
