from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.clip_video import Stage
from renderer.contact_shadow import ContactShadow, ShadowCaster
from renderer.framing import frame_clips
from renderer.look import BACKGROUND, Look

LEFT, RIGHT, TRUNK = 0, 1, 2


@pytest.fixture(scope="module")
def caster(body: BodyModel) -> ShadowCaster:
    return ShadowCaster(body)


@pytest.fixture(scope="module")
def standing(clip: MotionClip) -> MotionClip:
    return clip.frames(slice(0, 1))


Cast = Callable[[MotionClip], ContactShadow]


@pytest.fixture(scope="module")
def cast(caster: ShadowCaster, body: BodyModel) -> Cast:
    return lambda clip: caster.shadow(body.vertices(clip)[0], caster.ground(clip))


def _moved(clip: MotionClip, **joints: tuple[float, float, float]) -> MotionClip:
    poses = clip.poses.copy()
    for name, turn in joints.items():
        poses[:, joint_index(name)] = turn
    return replace(clip, poses=poses)


def test_the_ground_is_where_the_soles_are(
    caster: ShadowCaster, body: BodyModel, standing: MotionClip
) -> None:
    assert caster.ground(standing) == pytest.approx(float(body.template[:, 1].min()), abs=1e-3)


def test_each_foot_stands_on_its_own_shadow(cast: Cast, standing: MotionClip) -> None:
    shadow = cast(standing)
    assert shadow.centres[RIGHT, 0] < 0 < shadow.centres[LEFT, 0]
    assert abs(shadow.centres[TRUNK, 0]) < 0.1
    for foot in (LEFT, RIGHT):
        along, across = np.linalg.norm(shadow.axes[foot], axis=0)
        assert 0.12 < along < 0.3
        assert across < along


def test_a_lifted_foot_has_a_fainter_shadow_and_the_other_keeps_its_own(
    cast: Cast, standing: MotionClip
) -> None:
    on_both = cast(standing)
    on_one = cast(_moved(standing, left_hip=(-0.6, 0, 0), left_knee=(1.0, 0, 0)))
    assert on_one.darkness[LEFT] < on_both.darkness[LEFT] / 2
    assert on_one.darkness[RIGHT] == pytest.approx(on_both.darkness[RIGHT], rel=0.01)
    assert on_one.darkness[TRUNK] == pytest.approx(on_both.darkness[TRUNK], rel=0.01)


def test_a_jump_fades_all_of_it(cast: Cast, standing: MotionClip) -> None:
    jump = replace(standing, trans=standing.trans + np.array([0, 0.4, 0], np.float32))
    assert (cast(jump).darkness < cast(standing).darkness / 2).all()


def test_a_foot_under_the_ground_is_no_darker_than_one_on_it(
    cast: Cast, standing: MotionClip
) -> None:
    sunk = replace(standing, trans=standing.trans - np.array([0, 0.1, 0], np.float32))
    np.testing.assert_allclose(cast(sunk).darkness, cast(standing).darkness, atol=0.02)


def test_the_shadow_turns_with_the_foot(cast: Cast, standing: MotionClip) -> None:
    aside = cast(_moved(standing, left_hip=(0, 1.2, 0)))
    forwards = cast(standing)
    assert abs(aside.axes[LEFT][0, 0]) > 2 * abs(forwards.axes[LEFT][0, 0])


def test_a_whole_body_is_drawn_with_its_shadow_on_an_otherwise_plain_background(
    clip: MotionClip, body: BodyModel, body_path: Path
) -> None:
    look = Look(size=160, framing="full_body")
    with Stage(body_path, frame_clips([clip], body, look), look) as stage:
        picture = next(stage.pictures(clip.frames(slice(0, 1)))).astype(int)
    between_feet = picture[290:310, 150:170, :3]
    assert between_feet.min() < min(BACKGROUND) - 8
    for edge in (picture[:, 0], picture[:, -1], picture[0], picture[-1]):
        assert np.abs(edge[:, :3] - BACKGROUND).max() <= 1
