from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from motion.arrays import Floats32
from motion.body.model import read_body
from motion.clip import MotionClip
from motion.formats.ted_npz import JOINT_NAMES as TEN_JOINTS
from motion.points.joint_rotations import clip_from_joints
from motion.skeleton import BODY_JOINTS, JOINT_NAMES, PARENTS, joint_index
from renderer.look import default_body
from tests.motion.random_clips import joint_positions, largest_angle, random_clip

REST = read_body(default_body()).joints(np.zeros(0))


def chosen(clip: MotionClip, names: tuple[str, ...] = TEN_JOINTS) -> Floats32:
    return joint_positions(clip, REST)[:, [joint_index(name) for name in names]].astype(np.float32)


def clip_from(points: Floats32, names: tuple[str, ...] = TEN_JOINTS) -> MotionClip:
    joints = {name: points[:, index].astype(float) for index, name in enumerate(names)}
    return clip_from_joints(joints, REST, 30)


def bones(names: tuple[str, ...]) -> list[tuple[str, str]]:
    tree = [
        (JOINT_NAMES[parent], joint)
        for parent, joint in zip(PARENTS, JOINT_NAMES, strict=True)
        if parent >= 0 and joint in names and "hip" not in joint  # they turn with the trunk
    ]
    trunk = [("pelvis", "neck"), *(("neck", f"{side}_shoulder") for side in ("left", "right"))]
    return [bone for bone in [*tree, ("head", "jaw"), *trunk] if set(bone) <= set(names)]


def without_spine(names: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(name for name in names if "spine" not in name and "collar" not in name)


@settings(max_examples=20)
@given(
    names=st.sampled_from([TEN_JOINTS, *map(without_spine, (BODY_JOINTS, JOINT_NAMES))]),
    seed=st.integers(0, 2**32 - 1),
)
def test_every_bone_has_its_given_direction(names: tuple[str, ...], seed: int) -> None:
    clip = random_clip(6, seed=seed)
    clip = replace(clip, poses=clip.poses * 0.8)
    back = clip_from(chosen(clip, names), names)
    assert largest_angle(clip, back, bones(names), REST) < 0.1


def test_without_limbs_the_body_stands_with_arms_down_and_relaxed_hands() -> None:
    clip = random_clip(5)
    clip = replace(clip, poses=0.3 * clip.poses)
    needed = ("pelvis", "neck", "left_shoulder", "right_shoulder")
    back = clip_from(chosen(clip, needed), needed)
    after = joint_positions(back, REST)
    hips, feet = (
        after[:, [joint_index(f"{side}_{part}") for side in ("left", "right")]].mean(axis=1)
        for part in ("hip", "foot")
    )
    assert np.ptp(hips, axis=0).max() < 1e-5
    assert np.ptp(feet[:, 1]) < 1e-5
    assert (after[:, joint_index("left_wrist"), 1] < after[:, joint_index("neck"), 1]).all()
    assert np.abs(back.poses[:, joint_index("right_index1")]).max() > 0.1


def test_an_elbow_bends_only_the_way_it_can() -> None:
    clip = random_clip(5)
    poses = np.zeros_like(clip.poses)
    poses[:, joint_index("left_shoulder")] = [0.4, 0, -1.2]
    poses[:, joint_index("left_elbow")] = [0, -1.3, 0]
    still = replace(clip, poses=poses, trans=np.zeros_like(clip.trans))
    back = clip_from(chosen(still))
    for name, tolerance in (("left_elbow", 0.05), ("left_shoulder", 0.1)):
        place = joint_index(name)
        np.testing.assert_allclose(back.poses[:, place], poses[:, place], atol=tolerance)
