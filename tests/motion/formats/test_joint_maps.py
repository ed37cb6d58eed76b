from pathlib import Path

import pytest

from motion.errors import InputError
from motion.formats.joint_maps import (
    JOINT_MAPS,
    REQUIRED_JOINTS,
    check_joint_map,
    choose_joint_map,
    read_joint_map,
)
from motion.skeleton import JOINT_NAMES


def test_a_custom_map_is_read_from_plain_lines(tmp_path: Path) -> None:
    path = tmp_path / "joints.toml"
    path.write_text('pelvis = "Hips"\nleft_wrist = "Hand L"  # as exported\n')
    assert read_joint_map(path) == {"pelvis": "Hips", "left_wrist": "Hand L"}


@pytest.mark.parametrize("text", ["pelvis: Hips", "pelvis = 3", "[joints]\npelvis = 'Hips'"])
def test_a_file_other_than_a_joint_map_is_refused_by_name(tmp_path: Path, text: str) -> None:
    path = tmp_path / "joints.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=r"joints.toml: the file is not a joint map"):
        read_joint_map(path)


@pytest.mark.parametrize("name", JOINT_MAPS)
def test_every_known_map_is_valid(name: str) -> None:
    joint_map = JOINT_MAPS[name]
    assert set(joint_map) <= set(JOINT_NAMES)
    assert set(REQUIRED_JOINTS) <= set(joint_map)
    assert len(set(joint_map.values())) == len(joint_map)


@pytest.mark.parametrize("name", JOINT_MAPS)
def test_a_skeleton_is_recognised_by_its_joints(name: str) -> None:
    joints = [*JOINT_MAPS[name].values(), "HeadEnd", "LeftHandMiddle4", "b_l_arm_twist"]
    assert choose_joint_map(joints) == (name, JOINT_MAPS[name])


@pytest.mark.parametrize("prefix", ["mixamorig1:", "mixamorig_", "scene:actor:"])
def test_a_namespace_is_ignored(prefix: str) -> None:
    names = [prefix + joint for joint in JOINT_MAPS["mixamo"].values()]
    chosen, joint_map = choose_joint_map(names)
    assert chosen == "mixamo"
    assert joint_map["left_elbow"] == f"{prefix}LeftForeArm"


def test_a_skeleton_without_legs_and_fingers_suffices() -> None:
    names = [JOINT_MAPS["genea"][joint] for joint in (*REQUIRED_JOINTS, "spine1", "neck")]
    chosen, joint_map = choose_joint_map(names)
    assert chosen == "genea"
    assert set(joint_map) == {*REQUIRED_JOINTS, "spine1", "neck"}


def test_an_unknown_skeleton_is_refused_with_its_unmapped_joints() -> None:
    names = [name for name in JOINT_MAPS["beat"].values() if name != "LeftForeArm"]
    complaint = "'beat', leaves LeftFourArm, Tail unmapped.*no joint for left_elbow.*--joints FILE"
    with pytest.raises(InputError, match=complaint):
        choose_joint_map([*names, "LeftFourArm", "Tail"])


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"tail": "Tail"}, "names tail, which SMPL-X does not have"),
        ({"neck": "Throat"}, "names Throat, which the file does not have"),
        ({"left_knee": "Head"}, "lacks left_hip"),
        ({"head": None}, "lacks head"),
    ],
)
def test_a_custom_map_that_does_not_fit_is_refused(
    change: dict[str, str | None], complaint: str
) -> None:
    joint_map = {joint: joint.title() for joint in REQUIRED_JOINTS}
    names = {*joint_map.values(), "Tail"}
    changed = {joint: name for joint, name in (joint_map | change).items() if name is not None}
    with pytest.raises(InputError, match=complaint):
        check_joint_map(changed, names)
