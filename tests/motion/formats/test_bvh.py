from pathlib import Path

import numpy as np
import pybvh
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from motion.errors import InputError
from motion.formats.bvh import BvhFrameCountError, read_bvh
from tests.motion.formats.bvh_text import CHAIN, bvh_text, read_chain, save_bvh_text

ROWS = np.arange(36, dtype=float).reshape(3, 12)


def test_skeleton_and_values_are_read(tmp_path: Path) -> None:
    motion = read_chain(tmp_path, ROWS)
    assert motion.joint_names == ("hip", "knee", "ankle")
    assert [joint.parent for joint in motion.joints] == [-1, 0, 1]
    assert motion.joints[2].offset == (0, -42, 1)
    assert motion.joints[1].channels == ("Zrotation", "Xrotation", "Yrotation")
    np.testing.assert_array_equal(motion.values, ROWS)
    np.testing.assert_array_equal(motion.rest_positions[2], [0, -82, 1])
    assert motion.notes == ()


@pytest.mark.parametrize(
    ("frame_time", "rate"),
    [
        *(("0.0333333", 30), ("0.033", 30), ("0.008333", 120), ("4e-2", 25), ("1", 1)),
        *(("0.0333667", 29.97), ("0.067", 15), ("0.142857", 7), ("0.03", 33.3333)),
    ],
)
def test_a_rounded_frame_time_gives_the_exact_rate(
    tmp_path: Path, frame_time: str, rate: float
) -> None:
    assert read_chain(tmp_path, ROWS, frame_time=frame_time).frame_rate == pytest.approx(
        rate, abs=1e-3
    )


@given(
    order=st.permutations("XYZ").map("".join),
    angles=st.lists(st.floats(-180, 180), min_size=9, max_size=9),
)
def test_rotations_apply_in_the_order_of_the_channels(
    tmp_path_factory: pytest.TempPathFactory, order: str, angles: list[float]
) -> None:
    path = tmp_path_factory.mktemp("bvh") / "a.bvh"
    row = np.array([1, 2, 3, *angles])
    save_bvh_text(path, bvh_text(CHAIN, row[None], order=order))
    positions, rotations = read_bvh(path).forward_kinematics()
    other = pybvh.read_bvh_file(path, world_up="+y")
    places = [other.joint_names.index(name) for name in ("hip", "knee", "ankle")]
    np.testing.assert_allclose(positions, other.joint_positions()[:, places], atol=1e-4)
    hip = Rotation.from_euler(order, row[3:6], degrees=True).as_matrix()
    np.testing.assert_allclose(rotations[0, 0], hip, atol=1e-6)


def test_position_channels_replace_offsets_and_missing_rotations_follow_the_parent(
    tmp_path: Path,
) -> None:
    text = bvh_text(CHAIN, np.array([[0, 0, 0, 0, 0, 0, 0, 90, 0, 1, -50, 2]]))
    start, _, end = text.rpartition("CHANNELS 3 Zrotation Xrotation Yrotation")
    text = f"{start}CHANNELS 3 Xposition Yposition Zposition{end}"
    motion = read_bvh(save_bvh_text(tmp_path / "a.bvh", text))
    positions, rotations = motion.forward_kinematics()
    np.testing.assert_allclose(positions[0, 2], [1, -42, -50], atol=1e-9)
    np.testing.assert_array_equal(rotations[0, 2], rotations[0, 1])


def test_layout_of_the_text_does_not_matter(tmp_path: Path) -> None:
    plain = read_chain(tmp_path, ROWS)
    text = bvh_text(CHAIN, ROWS).replace("\n{", " {").replace("\n", "\r\n\r\n  ")
    text = "\ufeff" + text.replace("Zrotation", "ZROTATION").replace("ROOT", "root")
    odd = read_bvh(save_bvh_text(tmp_path / "b.bvh", text.replace("Frames: 3", "frames:\t3")))
    assert odd.joints == plain.joints
    np.testing.assert_array_equal(odd.values, plain.values)


@pytest.mark.parametrize(
    ("promised", "frame_rates"), [(24, (120, 15)), (25, (120, 15)), (4, (120,)), (0, (120,))]
)
def test_a_header_that_contradicts_the_rows_is_refused_with_possible_rates(
    tmp_path: Path, promised: int, frame_rates: tuple[float, ...]
) -> None:
    with pytest.raises(BvhFrameCountError) as refusal:
        read_chain(tmp_path, ROWS, frames=promised, frame_time="0.008333")
    assert (refusal.value.rows, refusal.value.frame_rates) == (3, frame_rates)
    for fact in ("a.bvh", f"{promised} frames", "120 per second", "3 rows", "--fps"):
        assert fact in str(refusal.value)
    motion = read_bvh(tmp_path / "a.bvh", frame_rate=15)
    assert motion.frame_rate == 15
    assert "read at 15 per second" in motion.notes[0]


HEADER = "'Frames: <number>' and a usable 'Frame Time: <seconds>' do not follow"
BAD_EDITS = [
    ("HIERARCHY", "HELLO", "the file is not a BVH", ""),
    ("JOINT knee", "JOINT", "'JOINT' does not fit", "line 6"),
    ("JOINT knee", "JOINT hip", "joint 'hip' occurs twice", ""),
    ("End Site", "", "'{' does not fit", "line 15"),
    ("}\n}\n}\n}", "}\n}\n}", "the skeleton is not complete", ""),
    ("}\n}\n}\n}", "}\n}\n}\n}\n}", "'}' does not fit", "line 21"),
    ("OFFSET 0.00000000 -40.0", "OFFSET x -40.0", "'OFFSET x .*' does not fit", "line 8"),
    ("OFFSET 0.00000000 -40.0", "OFFSET nan -40.0", "'OFFSET nan .*' does not fit", "line 8"),
    ("CHANNELS 3 Zrotation", "CHANNELS 3 Wrotation", "'CHANNELS 3 W.*' does not fit", "line 9"),
    ("CHANNELS 3 Zrotation", "CHANNELS 2 Zrotation", "'CHANNELS 2 .*' does not fit", "line 9"),
    *(("Frames: 3", f"Frames: {word}", HEADER, "line 21") for word in ("three", "9" * 5000)),
    *(
        ("Frame Time: 0.0333333", f"Frame Time: {word}", HEADER, "line 21")
        for word in ("fast", "NaN", "1e-999999")
    ),
    *(
        ("12 13 14", f"12 13{word}", "not hold 12 finite numbers", "line 25")
        for word in ("", " x", " -inf")
    ),
]


@pytest.mark.parametrize(("old", "new", "complaint", "place"), BAD_EDITS)
def test_damage_is_refused_by_file_and_line(
    tmp_path: Path, old: str, new: str, complaint: str, place: str
) -> None:
    text = bvh_text(CHAIN, ROWS)
    assert old in text
    path = save_bvh_text(tmp_path / "bad.bvh", text.replace(old, new, 1))
    with pytest.raises(InputError, match=complaint) as caught:
        read_bvh(path)
    assert caught.value.where.startswith(str(path))
    assert place in caught.value.where
    assert caught.value.remedy


@given(st.data())
def test_a_truncated_file_is_never_accepted(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    text = bvh_text(CHAIN, ROWS)
    whole_until = len(text) - len(" 35\n")
    cut = data.draw(st.integers(0, whole_until))
    path = save_bvh_text(tmp_path_factory.mktemp("bvh") / "cut.bvh", text[:cut])
    with pytest.raises(InputError, match=r"cut\.bvh"):
        read_bvh(path)


def test_a_skeleton_of_200000_nested_joints_is_refused_early(tmp_path: Path) -> None:
    joints = "".join(f"JOINT j{number}\n{{\nOFFSET 0 1 0\n" for number in range(200_000))
    path = save_bvh_text(
        tmp_path / "deep.bvh", f"HIERARCHY\nROOT r\n{{\nOFFSET 0 0 0\n{joints}MOTION\n"
    )

    with pytest.raises(InputError, match="more than 2000 joints") as caught:
        read_bvh(path)
    assert "line 6002" in caught.value.where
