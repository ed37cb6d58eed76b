import io
from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip
from motion.formats.smplx_rows import read_rows
from motion.skeleton import JOINT_NAMES, joint_index

TALKSHOW = {"jaw": 0, "left_eye": 3, "pelvis": 9, "left_hip": 12, "right_wrist": 72}
TALKSHOW |= {"left_index1": 75, "left_thumb3": 117, "right_thumb3": 162}
MOTION_X = {"pelvis": 0, "left_hip": 3, "right_wrist": 63, "left_index1": 66}
MOTION_X |= {"right_thumb3": 153, "jaw": 156}


@pytest.mark.parametrize(
    ("format_name", "width", "places", "expressions"),
    [("talkshow", 265, TALKSHOW, slice(165, 265)), ("motion-x", 322, MOTION_X, slice(159, 209))],
)
def test_every_channel_lands_on_its_joint(
    tmp_path: Path, format_name: str, width: int, places: dict[str, int], expressions: slice
) -> None:
    row = np.arange(width) / 1000
    np.save(tmp_path / "a.npy", np.tile(row, (3, 1)))
    clip = read_rows(tmp_path / "a.npy")
    assert (clip.provenance["format"], clip.frame_rate) == (format_name, 30)
    for name, column in places.items():
        joint = clip.poses[1, joint_index(name)]
        np.testing.assert_allclose(joint, row[column : column + 3], err_msg=name)
    assert clip.expressions is not None
    given = row[expressions]
    np.testing.assert_allclose(clip.expressions[2, : len(given)], given)
    if format_name == "motion-x":
        assert not clip.poses[:, joint_index("left_eye")].any()
        np.testing.assert_allclose(clip.trans[2], row[309:312])
        np.testing.assert_allclose(clip.betas, row[312:])
        np.savez(tmp_path / "a.npz", poses=np.tile(row, (3, 1)), fps=30)
        np.testing.assert_array_equal(read_clip(tmp_path / "a.npz").poses, clip.poses)
    else:
        assert len(np.unique(clip.poses)) == 3 * len(JOINT_NAMES)
        assert not clip.trans.any()


def endless() -> bytes:
    """Return the header of an array of more frames than any memory holds."""
    file = io.BytesIO()
    header = {"descr": "<f4", "fortran_order": False, "shape": (10**12, 265)}
    np.lib.format.write_array_header_1_0(file, header)
    return file.getvalue()


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        (np.zeros((3, 264)), r"shape \(3, 264\)"),
        (np.full((3, 265), np.inf), "holds inf at"),
        (np.full((3, 265), "x"), "type <U1"),
        (np.array([None]), "plain array"),
        (b"\x93NUMPY", "plain array"),
        (endless(), "plain array"),
    ],
)
def test_other_files_are_refused_by_name(
    tmp_path: Path, content: np.ndarray | bytes, complaint: str
) -> None:
    if isinstance(content, bytes):
        (tmp_path / "bad.npy").write_bytes(content)
    else:
        np.save(tmp_path / "bad.npy", content, allow_pickle=True)
    with pytest.raises(InputError, match=rf"bad\.npy: .*{complaint}"):
        read_rows(tmp_path / "bad.npy")
