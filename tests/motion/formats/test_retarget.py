from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.body.skinning import twist_angles
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.bvh_motion import BvhJoint, BvhMotion
from motion.formats.joint_maps import JOINT_MAPS
from motion.formats.retarget import retarget
from motion.skeleton import JOINT_NAMES, PARENTS, REST_JOINTS, forward_kinematics, joint_index

OWN = JOINT_MAPS["smplx"]
LIMB_BONES = [
    (f"{side}_{joint}", f"{side}_{child}")
    for side in ("left", "right")
    for joint, child in (
        *(("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle")),
        *(("wrist", "middle1"), ("index1", "index2"), ("index2", "index3")),
        *(("pinky1", "pinky2"), ("thumb1", "thumb2"), ("thumb2", "thumb3")),
    )
]


Offset = tuple[float, float, float]
Skeleton = dict[str, Offset]
"""Offsets of SMPL-X's joints, in centimetres."""

TURNS = ("Zrotation", "Xrotation", "Yrotation")
ROOT = ("Xposition", "Yposition", "Zposition", *TURNS)


def changed(
    change: Callable[[str, Offset], Offset] = lambda _, offset: offset, scale: float = 100
) -> Skeleton:
    """Return SMPL-X's skeleton with every offset changed by `change`."""
    bones = REST_JOINTS - np.where(np.array(PARENTS)[:, None] < 0, 0, REST_JOINTS[list(PARENTS)])
    return {
        name: change(name, (x, y, z))
        for name, (x, y, z) in zip(JOINT_NAMES, (scale * bones).tolist(), strict=True)
    }


def bvh_motion(
    skeleton: Skeleton, turns: Rotation, root: np.ndarray | None = None, prefix: str = ""
) -> BvhMotion:
    """Return a motion with `turns` (T * J) as its rotations; `prefix` is put before all names."""
    names = [prefix + name for name in skeleton]
    joints = []
    for name, offset in skeleton.items():
        parent = PARENTS[joint_index(name)]
        place = names.index(prefix + JOINT_NAMES[parent]) if parent >= 0 else -1
        channels = TURNS if parent >= 0 else ROOT
        joints.append(BvhJoint(name=prefix + name, parent=place, offset=offset, channels=channels))
    angles = turns.as_euler("ZXY", degrees=True).reshape(-1, 3 * len(joints))
    root = np.zeros((len(angles), 3)) if root is None else root
    return BvhMotion(joints=tuple(joints), values=np.hstack([root, angles]), frame_rate=30)


def random_turns(frames: int, seed: int) -> Rotation:
    rng = np.random.default_rng(seed)
    return Rotation.from_rotvec(rng.uniform(-0.8, 0.8, (frames * len(JOINT_NAMES), 3)))


def at_rest(skeleton: Skeleton) -> MotionClip:
    """Return a frame of `skeleton` in its rest pose."""
    return retarget(bvh_motion(skeleton, Rotation.identity(len(skeleton))), OWN)


def turned_by(axis: str, degrees: float, offset: Offset) -> Offset:
    x, y, z = Rotation.from_euler(axis, degrees, degrees=True).apply(offset)
    return (x, y, z)


def is_finger(name: str) -> bool:
    return name[-1] in "123" and "spine" not in name


def is_arm(name: str) -> bool:
    return "elbow" in name or "wrist" in name or is_finger(name)


def sign_of(name: str) -> int:
    return 1 if name.startswith("left") else -1


def directions(positions: np.ndarray, start: int, end: int) -> np.ndarray:
    bone = positions[:, end] - positions[:, start]
    return np.asarray(bone / np.linalg.norm(bone, axis=1, keepdims=True))


@given(st.integers(0, 999))
@settings(max_examples=20)
def test_retargeting_smplx_motion_changes_nothing(seed: int) -> None:
    turns = random_turns(3, seed)
    clip = retarget(bvh_motion(changed(), turns), OWN)
    np.testing.assert_allclose(clip.poses, turns.as_rotvec().reshape(3, -1, 3), atol=1e-5)


@given(seed=st.integers(0, 999), droop=st.floats(-80, 60), spread=st.floats(0, 20))
@settings(max_examples=30)
def test_limbs_keep_the_sources_directions_for_any_rest_pose(
    seed: int, droop: float, spread: float
) -> None:
    def bent(name: str, offset: Offset) -> Offset:
        leg = "knee" in name or "ankle" in name
        angle = droop if is_arm(name) else spread if leg else 0
        return turned_by("z", sign_of(name) * angle, offset)

    skeleton = changed(bent)
    motion = bvh_motion(skeleton, random_turns(4, seed))
    clip = retarget(motion, OWN)
    source, _ = motion.forward_kinematics()
    target, _ = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    for bone in LIMB_BONES:
        expected = directions(source, *map(motion.joint_names.index, bone))
        result = directions(target, *map(joint_index, bone))
        np.testing.assert_allclose(result, expected, atol=1e-3)


def test_palms_face_as_the_sources_fingers_imply() -> None:
    clip = at_rest(
        changed(lambda name, offset: turned_by("x", -90, offset) if is_finger(name) else offset)
    )
    _, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    for side in ("left", "right"):
        palm = rotations[0, joint_index(f"{side}_wrist")] @ [0, -1, 0]
        np.testing.assert_allclose(palm, [0, 0, 1], atol=0.05)
        assert not clip.poses[0, joint_index(f"{side}_elbow")].any()


@pytest.mark.parametrize(
    "turn",
    [
        Rotation.from_euler("x", 90, degrees=True),
        Rotation.from_euler("y", 90, degrees=True),
        Rotation.from_euler("yx", [-40, 25], degrees=True),
    ],
)
def test_axes_of_the_source_only_turn_the_root(turn: Rotation) -> None:
    turns = random_turns(3, 1)
    skeleton = changed(lambda _, offset: tuple(turn.apply(offset)))
    turned = bvh_motion(skeleton, turn * turns * turn.inv())
    clips = [retarget(bvh_motion(changed(), turns), OWN), retarget(turned, OWN)]
    np.testing.assert_allclose(clips[0].poses[:, 1:], clips[1].poses[:, 1:], atol=1e-5)
    roots = [Rotation.from_rotvec(clip.poses[:, 0]) for clip in clips]
    assert ((turn * roots[0]).inv() * roots[1]).magnitude().max() < 1e-5


def test_joints_without_a_source_follow_their_parent() -> None:
    joint_map = {name: name for name in JOINT_NAMES if "index" not in name and name != "spine2"}
    clip = retarget(bvh_motion(changed(), random_turns(2, 0)), joint_map)
    for name in set(JOINT_NAMES) - set(joint_map):
        np.testing.assert_allclose(clip.poses[:, joint_index(name)], 0, atol=1e-6)


@pytest.mark.parametrize("scale", [1, 2.54, 100, 1000])
def test_length_unit_and_body_size_do_not_matter(scale: float) -> None:
    skeleton = changed(scale=scale)
    root = scale * np.array([[0, 0, 0], [0.1, 0.2, 0.3]])
    motion = bvh_motion(skeleton, Rotation.identity(2 * len(skeleton)), root)
    np.testing.assert_allclose(retarget(motion, OWN).trans, root / scale, atol=1e-5)


def test_rest_pose_that_does_not_stand_is_refused() -> None:
    def folded(name: str, offset: Offset) -> Offset:
        x, y, z = offset
        return (x, -y, z) if "knee" in name or "ankle" in name else offset

    with pytest.raises(InputError, match=r"not a standing figure.*T-pose"):
        at_rest(changed(folded))


def leaning(name: str, offset: Offset) -> Offset:
    x, y, z = offset
    return (x, y, z + 3) if "spine" in name or name == "neck" else offset


def fingerless(name: str, offset: Offset) -> Offset:
    return (0, 0, 0) if is_finger(name) else offset


@pytest.mark.parametrize("change", [leaning, fingerless])
def test_leaning_spines_and_zero_length_fingers_at_rest_rotate_nothing(
    change: Callable[[str, Offset], Offset],
) -> None:
    np.testing.assert_allclose(at_rest(changed(change)).poses, 0, atol=1e-6)


def test_a_skeleton_without_legs_is_scaled_by_its_arms() -> None:
    legs = ("hip", "knee", "ankle", "foot")
    above = {name: name for name in JOINT_NAMES if not name.endswith(legs)}
    skeleton = {name: offset for name, offset in changed(scale=50).items() if name in above}
    root = np.array([[50.0, 0, 0]])
    clip = retarget(bvh_motion(skeleton, Rotation.identity(len(skeleton)), root), above)
    np.testing.assert_allclose(clip.trans, [[1, 0, 0]], atol=1e-6)
    assert not clip.poses[:, joint_index("left_knee")].any()


FOREIGN = {name: f"x_{name}" for name in JOINT_NAMES}


@given(st.integers(0, 999))
@settings(max_examples=20)
def test_elbow_and_wrist_share_the_twist_of_a_foreign_forearm(seed: int) -> None:
    turns_at_joints = random_turns(3, seed)
    clip = retarget(bvh_motion(changed(), turns_at_joints, prefix="x_"), FOREIGN)
    same = retarget(bvh_motion(changed(), turns_at_joints), OWN)
    turns = [forward_kinematics(each.poses, each.trans, REST_JOINTS)[1] for each in (clip, same)]
    for side in ("left", "right"):
        elbow, wrist = joint_index(f"{side}_elbow"), joint_index(f"{side}_wrist")
        axis = REST_JOINTS[wrist] - REST_JOINTS[elbow]
        axis = axis / np.linalg.norm(axis)
        at_elbow, at_wrist = (
            twist_angles(Rotation.from_rotvec(clip.poses[:, joint]).as_quat(), axis)
            for joint in (elbow, wrist)
        )
        np.testing.assert_allclose(at_elbow, at_wrist, atol=1e-4)
        np.testing.assert_allclose(turns[0][:, wrist], turns[1][:, wrist], atol=1e-5)
        np.testing.assert_allclose(turns[0][:, elbow] @ axis, turns[1][:, elbow] @ axis, atol=1e-5)


def test_a_forearm_that_twists_past_half_a_turn_does_not_jump() -> None:
    elbow, wrist = joint_index("left_elbow"), joint_index("left_wrist")
    axis = REST_JOINTS[wrist] - REST_JOINTS[elbow]
    vectors = np.zeros((31, 55, 3))
    degrees = np.linspace(150, 210, len(vectors))
    vectors[:, elbow] = np.radians(degrees)[:, None] * axis / np.linalg.norm(axis)
    motion = bvh_motion(changed(), Rotation.from_rotvec(vectors.reshape(-1, 3)), prefix="x_")
    clip = retarget(motion, FOREIGN)
    for joint in (elbow, wrist):
        turns = Rotation.from_rotvec(clip.poses[:, joint])
        assert np.degrees((turns[:-1].inv() * turns[1:]).magnitude()).max() < 1.1


def _in_t_pose(calibration: dict[str, float], heading: float = 0) -> MotionClip:
    """Return one still frame of SMPL-X's skeleton, calibrated with joints pitched by degrees.

    In the frame these joints are pitched as they were in the T-pose.
    """
    vectors = np.zeros((55, 3))
    for name, pitch in calibration.items():
        vectors[joint_index(name), 0] = np.radians(pitch)
    turned = Rotation.from_euler("y", heading, degrees=True)
    vectors[0] = (turned * Rotation.from_rotvec(vectors[0])).as_rotvec()
    motion = bvh_motion(changed(), Rotation.from_rotvec(vectors))
    return retarget(replace(motion, calibration=motion.values[0]), OWN)


@pytest.mark.parametrize("heading", [0, 90, -160])
def test_a_calibration_pose_straightens_head_and_trunk(heading: float) -> None:
    pitched: dict[str, float] = {"pelvis": -6, "spine1": 11, "spine2": -5, "neck": 13}
    clip = _in_t_pose(pitched, heading)
    _, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    facing = [np.sin(np.radians(heading)), 0, np.cos(np.radians(heading))]
    for joint in ("pelvis", "spine1", "spine3", "neck", "head"):
        world = rotations[0, joint_index(joint)]
        np.testing.assert_allclose(world @ [0, 0, 1], facing, atol=1e-5)
        np.testing.assert_allclose(world @ [0, 1, 0], [0, 1, 0], atol=1e-5)


@pytest.mark.parametrize("pose", [{"pelvis": 80}, {"left_shoulder": 10, "spine2": 50}])
def test_any_other_first_pose_straightens_nothing(pose: dict[str, float]) -> None:
    clip = _in_t_pose(pose)
    for joint, pitch in pose.items():
        bend = np.degrees(clip.poses[0, joint_index(joint), 0])
        assert bend == pytest.approx(pitch, abs=1e-3)


def test_a_real_speaker_stands_upright_with_hands_in_front(shared_data: Path) -> None:
    clip = read_motion(shared_data / "2_scott_0_1_1.bvh", frame_rate=15, as_recorded=True)
    assert clip.duration == pytest.approx(63.8)
    assert clip.provenance["format"] == "bvh (beat)"
    assert "7669 frames" in clip.provenance["notes"]
    positions, rotations = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    trunk = directions(positions, joint_index("pelvis"), joint_index("head"))
    assert trunk[:, 1].min() > np.cos(np.radians(35))
    assert (rotations[:, joint_index("head")] @ [0, 0, 1])[:, 2].mean() > 0.9
    for side, sign in (("left", 1), ("right", -1)):
        wrist = positions[:, joint_index(f"{side}_wrist")]
        assert wrist[:, 2].mean() > positions[:, joint_index("spine3"), 2].mean()
        assert (sign * (wrist - positions[:, 0])[:, 0] > -0.2).all()
        palm = rotations[:, joint_index(f"{side}_wrist")] @ [0, -1, 0]
        assert sign * palm[:, 0].mean() < -0.5
        bend = np.linalg.norm(clip.poses[:, joint_index(f"{side}_wrist")], axis=1)
        assert np.degrees(bend).max() < 60
