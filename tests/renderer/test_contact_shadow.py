from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.contact_shadow import ContactShadow, ShadowCaster

LEFT, RIGHT, TRUNK = 0, 1, 2


@pytest.fixture(scope="module")
def standing(clip: MotionClip) -> MotionClip:
    return clip.frames(slice(0, 1))


Cast = Callable[[MotionClip], ContactShadow]


@pytest.fixture(scope="module")
def cast(body: BodyModel) -> Cast:
    caster = ShadowCaster(body)
    return lambda clip: caster.shadow(body.vertices(clip)[0], caster.ground(clip))


def _raised(clip: MotionClip, metres: float) -> MotionClip:
    return replace(clip, trans=clip.trans + np.array([0, metres, 0], np.float32))


def _moved(clip: MotionClip, **joints: tuple[float, float, float]) -> MotionClip:
    poses = clip.poses.copy()
    for name, turn in joints.items():
        poses[:, joint_index(name)] = turn
    return replace(clip, poses=poses)


def test_each_foot_has_its_own_shadow_that_turns_with_it(cast: Cast, standing: MotionClip) -> None:
    shadow = cast(standing)
    assert shadow.centres[RIGHT, 0] < 0 < shadow.centres[LEFT, 0]
    assert abs(shadow.centres[TRUNK, 0]) < 0.1
    for foot in (LEFT, RIGHT):
        along, across = np.linalg.norm(shadow.axes[foot], axis=0)
        assert 0.12 < along < 0.3
        assert across < along
    aside = cast(_moved(standing, left_hip=(0, 1.2, 0)))
    assert abs(aside.axes[LEFT][0, 0]) > 2 * abs(shadow.axes[LEFT][0, 0])


def test_a_shadow_fades_with_a_lifted_foot_and_never_darkens_below_ground(
    cast: Cast, standing: MotionClip
) -> None:
    on_both = cast(standing)
    on_one = cast(_moved(standing, left_hip=(-0.6, 0, 0), left_knee=(1.0, 0, 0)))
    assert on_one.darkness[LEFT] < on_both.darkness[LEFT] / 2
    assert on_one.darkness[RIGHT] == pytest.approx(on_both.darkness[RIGHT], rel=0.01)
    assert on_one.darkness[TRUNK] == pytest.approx(on_both.darkness[TRUNK], rel=0.01)
    assert (cast(_raised(standing, 0.4)).darkness < on_both.darkness / 2).all()
    np.testing.assert_allclose(cast(_raised(standing, -0.1)).darkness, on_both.darkness, atol=0.02)
