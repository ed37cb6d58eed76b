from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.evaluators.published_presets import ted_joints
from benchmarks.rendering.sample_motion import gesturing_clip
from motion.arrays import Floats
from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats import read_motion
from motion.formats.ted_npz import BONES, read_ted_npz
from motion.skeleton import BODY_JOINTS, REST_JOINTS, forward_kinematics, joint_index
from tests.motion.random_clips import joint_positions, largest_angle

ARMS = [
    (f"{side}_{start}", f"{side}_{end}")
    for side in ("left", "right")
    for start, end in (("shoulder", "elbow"), ("elbow", "wrist"))
]


CLIP = gesturing_clip(3, 30)


def detected(clip: MotionClip) -> dict[str, Floats]:
    """Return the points of a perfect detector."""
    at, turns = forward_kinematics(clip.poses, clip.trans, REST_JOINTS)
    head, rotations = at[:, joint_index("head")], turns[:, joint_index("head")]
    names = ("shoulder", "elbow", "wrist", "hip")
    result = {
        f"{side}_{part}": at[:, joint_index(f"{side}_{part}")]
        for side in ("left", "right")
        for part in names
    }
    ears = {"left_ear": [0.08, 0.05, 0], "right_ear": [-0.08, 0.05, 0], "nose": [0, 0.026, 0.12]}
    return result | {name: head + rotations @ np.array(place) for name, place in ears.items()}


def test_units_and_up_axes_of_named_joints_do_not_matter(tmp_path: Path) -> None:
    at = joint_positions(CLIP)[:, : len(BODY_JOINTS)]
    up = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    np.savez(tmp_path / "y.npz", joints=at, names=BODY_JOINTS, fps=30)
    np.savez(tmp_path / "z.npz", joints=1000 * at @ up.T + 5, names=BODY_JOINTS, fps=30)
    np.save(tmp_path / "order.npy", at)
    clips = [
        read_motion(tmp_path / "y.npz"),
        read_motion(tmp_path / "z.npz"),
        read_motion(tmp_path / "order.npy", frame_rate=30),
    ]
    assert largest_angle(clips[0], CLIP, ARMS) < 1
    for other in clips[1:]:
        np.testing.assert_allclose(other.poses, clips[0].poses, atol=1e-3)
    assert clips[0].provenance["format"] == "joint positions"
    assert "bones have our body's lengths" in clips[0].provenance["notes"]


def test_joints_named_by_another_tool_and_seen_by_a_camera_are_read(tmp_path: Path) -> None:
    points = {
        "".join(word.title() for word in name.split("_")): values
        for name, values in detected(CLIP).items()
    }
    camera = Rotation.from_euler("xy", [190, 25], degrees=True)
    seen = np.stack([camera.apply(values) for values in points.values()], axis=1)
    np.savez(tmp_path / "seen.npz", joints=seen, names=list(points), fps=30)
    result = read_motion(tmp_path / "seen.npz")
    assert largest_angle(result, CLIP, ARMS) < 6
    rotation = result.poses[:, joint_index("neck")] + result.poses[:, joint_index("head")]
    np.testing.assert_allclose(rotation[:, 1], CLIP.poses[:, joint_index("head"), 1], atol=0.06)


def test_a_joint_map_names_an_unknown_skeleton(tmp_path: Path) -> None:
    names = [f"j{number}" for number in range(22)]
    np.savez(tmp_path / "a.npz", joints=joint_positions(CLIP)[:, :22], names=names, fps=30)
    with pytest.raises(InputError, match=r"a\.npz: the joints lack left_shoulder.*; they are j0"):
        read_motion(tmp_path / "a.npz")
    joint_map = dict(zip(BODY_JOINTS, names, strict=True))
    assert largest_angle(read_motion(tmp_path / "a.npz", joint_map=joint_map), CLIP, ARMS) < 1
    with pytest.raises(InputError, match="no joint 'x'"):
        read_motion(tmp_path / "a.npz", joint_map={"pelvis": "x"})


def test_clips_of_ted_gesture_are_read_as_motion(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", joints=ted_joints(CLIP), frame_rate=30)
    assert largest_angle(read_motion(tmp_path / "a.npz"), CLIP, ARMS) < 4


NAMED: dict[str, Any] = {"joints": np.zeros((3, 22, 3)), "names": BODY_JOINTS, "fps": 30}


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ({"joints": np.zeros((3, 7, 3)), "fps": 30}, "0 known names"),
        (NAMED | {"joints": np.zeros((3, 22, 2))}, "not in a picture"),
        ({"joints": np.zeros((3, 22, 3)), "names": BODY_JOINTS}, "no frame rate"),
        (NAMED, "one point in frame 0"),
        (NAMED | {"joints": np.full((3, 22, 3), np.nan)}, "is not a number"),
        (NAMED | {"joints": np.zeros((0, 22, 3))}, r"shape \(0, 22, 3\)"),
        (NAMED | {"joints": np.zeros((3, 1, 3)), "names": ["pelvis"]}, "lack left_shoulder"),
    ],
)
def test_an_unusable_file_is_refused_with_the_reason(
    tmp_path: Path, content: dict[str, Any], sentence: str
) -> None:
    np.savez(tmp_path / "a.npz", **content)
    with pytest.raises(InputError, match=rf"a\.npz: .*{sentence}"):
        read_motion(tmp_path / "a.npz")


JOINTS = np.random.default_rng(1).uniform(-1, 1, (4, 10, 3))


def test_joints_and_directions_are_read_alike(tmp_path: Path) -> None:
    bones = np.stack([JOINTS[:, child] - JOINTS[:, parent] for parent, child in BONES], axis=1)
    expected = bones / np.linalg.norm(bones, axis=2, keepdims=True)
    np.savez(tmp_path / "joints.npz", joints=JOINTS * 7)
    np.savez(tmp_path / "flat.npz", directions=expected.reshape(4, 27), frame_rate=25)
    np.savez(tmp_path / "deep.npz", directions=expected)
    for name in ("joints", "flat", "deep"):
        np.testing.assert_allclose(
            read_ted_npz(tmp_path / f"{name}.npz").directions, expected, atol=1e-6
        )
    assert read_ted_npz(tmp_path / "joints.npz").frame_rate == 15
    assert read_ted_npz(tmp_path / "flat.npz").frame_rate == 25


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"poses": JOINTS}, "holds no motion of TED Gesture"),
        ({"joints": JOINTS[:, :9]}, r"Give numbers of shape \(frames, 30\) or \(frames, 10, 3\)"),
        ({"joints": JOINTS * np.nan}, "frame 0 holds no number"),
        ({"joints": 0 * JOINTS}, "bone 0 has no length in frame 0"),
        ({"directions": np.full((3, 27), 0.5)}, "a direction has length"),
    ],
)
def test_an_error_names_the_file_with_unusable_arrays(
    tmp_path: Path, arrays: dict[str, Any], message: str
) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=rf"a\.npz: .*{message}"):
        read_ted_npz(tmp_path / "a.npz")
