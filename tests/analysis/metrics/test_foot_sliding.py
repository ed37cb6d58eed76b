from __future__ import annotations

import math

import numpy as np
import pytest

from analysis.metrics.foot_sliding import CONTACT_HEIGHT, foot_sliding


def feet(frames=60, *, speed=0.0, frame_rate=30.0, lifted=0.0):
    """Return two feet, side by side, of which the second is lifted and both glide along z."""
    positions = np.zeros((frames, 2, 3))
    positions[:, 0, 0] = 0.2
    positions[:, :, 2] = speed * np.arange(frames)[:, None] / frame_rate
    positions[:, 1, 1] = lifted
    return positions


@pytest.mark.parametrize("frame_rate", [15.0, 60.0])
def test_gliding_feet_slide_as_fast_as_they_glide(frame_rate):
    found = foot_sliding(feet(speed=0.4, frame_rate=frame_rate), frame_rate=frame_rate)
    assert found.value == pytest.approx(0.4)
    assert found.unit == "m/s"


def test_standing_feet_do_not_slide():
    assert foot_sliding(feet(), frame_rate=30).value == 0


def test_a_foot_in_the_air_may_move():
    found = foot_sliding(feet(speed=0.4, lifted=0.1), frame_rate=30)
    assert found.n == 59
    assert found.value == pytest.approx(0.4)
    walking = feet(lifted=0.1)
    walking[:, 1, 2] = np.linspace(0, 2, 60)
    assert foot_sliding(walking, frame_rate=30).value == 0


def test_sliding_fades_with_height():
    half = foot_sliding(feet(speed=0.4, lifted=CONTACT_HEIGHT / 2), frame_rate=30)
    expected = 0.4 * (1 + 2 - math.sqrt(2)) / 2
    assert half.value == pytest.approx(expected)


def test_where_the_body_stands_and_which_way_it_faces_does_not_matter():
    gliding = feet(speed=0.3)
    turned = gliding[..., [2, 1, 0]] + [3.0, 1.0, -2.0]
    assert foot_sliding(turned, frame_rate=30).value == pytest.approx(
        foot_sliding(gliding, frame_rate=30).value
    )


def test_feet_that_never_stand_have_no_score_but_a_reason():
    flying = feet()
    flying[::2, :, 1] = 1.0
    found = foot_sliding(flying, frame_rate=30)
    assert math.isnan(found.value)
    assert "no foot stays" in found.reason
    assert foot_sliding(feet(1), frame_rate=30).reason == "a speed needs two frames"
