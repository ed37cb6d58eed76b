import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.clip_npz import has_provenance, read_clip, read_frame_rate, write_clip
from tests.motion.random_clips import assert_same_clip, clips, random_clip


def save(path: Path, **arrays: Any) -> Path:
    """Save a file as another project would; None leaves a key out."""
    fields: dict[str, Any] = {
        "poses": np.full((4, 165), 0.1),
        "trans": np.zeros((4, 3)),
        "betas": np.zeros(16),
        "gender": "female",
        "mocap_frame_rate": 30,
        **arrays,
    }
    np.savez(path, **{key: value for key, value in fields.items() if value is not None})
    return path


@given(clips())
def test_clips_survive_a_round_trip(
    tmp_path_factory: pytest.TempPathFactory, clip: MotionClip
) -> None:
    path = tmp_path_factory.mktemp("motion") / "a.npz"
    write_clip(path, clip)
    assert_same_clip(read_clip(path), clip)
    assert has_provenance(path)


def test_equal_clips_make_equal_bytes(tmp_path: Path) -> None:
    write_clip(tmp_path / "a.npz", random_clip())
    clip = random_clip()
    facts = dict(reversed(list(clip.provenance.items())))
    write_clip(tmp_path / "b.npz", replace(clip, provenance=facts))
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert {entry.date_time for entry in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


@pytest.mark.parametrize(
    "arrays",
    [
        {"poses": np.full((4, 55, 3), 0.1)},
        {"mocap_frame_rate": None, "mocap_framerate": np.array(30.0)},
        {"mocap_frame_rate": None, "fps": np.array([30])},
        {"gender": np.array(b"female")},
        {"gender": np.array(["female"])},
        {"betas": np.zeros((4, 16))},
        {"trans": None, "transl": np.zeros((4, 3))},
        {"trans": None},
        # MoSh++ keeps the markers of each frame in an array of Python objects.
        {"dmpls": np.zeros((4, 8)), "markers_latent_vids": np.array({"C7": 3}, dtype=object)},
    ],
)
def test_variants_of_the_file_convention_are_read_alike(
    tmp_path: Path, arrays: dict[str, Any]
) -> None:
    clip = read_clip(save(tmp_path / "a.npz", **arrays))
    assert clip.poses.shape == (4, 55, 3)
    assert np.allclose(clip.poses, 0.1)
    assert clip.frame_rate == 30
    assert clip.gender == "female"
    assert clip.betas.shape == (16,)
    assert not has_provenance(tmp_path / "a.npz")


@pytest.mark.parametrize(("joints", "flat"), [(24, True), (52, False)])
def test_joints_missing_from_smpl_and_smplh_are_at_rest(
    tmp_path: Path, joints: int, flat: bool
) -> None:
    rows = np.arange(4 * joints * 3, dtype=float).reshape(4, joints, 3) / 1000
    clip = read_clip(save(tmp_path / "a.npz", poses=rows.reshape(4, -1) if flat else rows))
    np.testing.assert_allclose(clip.poses[:, :22], rows[:, :22])
    assert not clip.poses[:, 22:25].any()
    fingers = rows[:, 22:] if joints == 52 else np.zeros((4, 30, 3))
    np.testing.assert_allclose(clip.poses[:, 25:], fingers)


WHOLE = np.arange(4 * 165, dtype=float).reshape(4, 165) / 1000
NAMES = ("root_orient", "pose_body", "pose_jaw", "pose_eye", "pose_hand")
PARTS = dict(zip(NAMES, np.split(WHOLE, [3, 66, 69, 75], axis=1), strict=True))


def test_poses_in_parts_are_joined_and_missing_parts_are_at_rest(tmp_path: Path) -> None:
    clip = read_clip(save(tmp_path / "a.npz", poses=None, **PARTS))
    np.testing.assert_allclose(clip.poses.reshape(4, 165), WHOLE)
    face_left_out = PARTS | {"pose_jaw": None, "pose_eye": None}
    clip = read_clip(save(tmp_path / "a.npz", poses=None, **face_left_out))
    assert not clip.poses[:, 22:25].any()
    np.testing.assert_allclose(clip.poses[:, 25:].reshape(4, 90), WHOLE[:, 75:])


@pytest.mark.parametrize("key", ["expression", "expressions"])
def test_missing_expression_coefficients_are_zero(tmp_path: Path, key: str) -> None:
    clip = read_clip(save(tmp_path / "a.npz", **{key: np.ones((4, 50))}))
    assert clip.expressions is not None
    assert clip.expressions[:, :50].all()
    assert not clip.expressions[:, 50:].any()


BAD_POSES = np.zeros((4, 165))
BAD_POSES[2, 7] = np.nan


@pytest.mark.parametrize(
    ("arrays", "complaint"),
    [
        ({"poses": None}, "no 'poses', only betas, gender"),
        ({"poses": np.zeros((4, 75))}, r"poses has shape \(4, 75\)"),
        ({"poses": None} | PARTS | {"pose_body": np.zeros((4, 60))}, r"pose_body has shape"),
        ({"poses": np.array([["a"] * 165])}, "'poses' holds no numbers"),
        ({"poses": BAD_POSES}, r"nan at index \(2, 2, 1\)"),
        ({"expressions": np.zeros((4, 101))}, "expressions has shape"),
        ({"betas": np.arange(8.0).reshape(4, 2)}, "betas change"),
        ({"mocap_frame_rate": None}, "no frame rate"),
        ({"gender": np.array(["male", "female"])}, "unknown gender .*male.*female"),
        ({"provenance": '{"seed": 1}'}, "provenance is not a JSON object of texts"),
    ],
)
def test_an_error_names_the_file_with_bad_content(
    tmp_path: Path, arrays: dict[str, Any], complaint: str
) -> None:
    path = save(tmp_path / "bad.npz", **arrays)
    with pytest.raises(InputError, match=complaint) as caught:
        read_clip(path)
    assert caught.value.where == str(path)
    assert caught.value.remedy


def test_pickle_is_never_loaded(tmp_path: Path) -> None:
    class Bomb:
        def __reduce__(self) -> tuple[Any, ...]:
            return (Path.touch, (tmp_path / "exploded",))

    path = save(tmp_path / "a.npz", poses=np.array([Bomb()], dtype=object))
    with pytest.raises(InputError, match="Python objects, which are never loaded"):
        read_clip(path)
    assert not (tmp_path / "exploded").exists()


def test_truncated_and_damaged_archives_are_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    write_clip(path, random_clip())
    content = path.read_bytes()
    path.write_bytes(content[:-200])
    with pytest.raises(
        InputError, match=r"a\.npz: the file is not an \.npz archive, or is truncated"
    ):
        read_clip(path)
    path.write_bytes(content[:60] + bytes(440) + content[500:])
    with pytest.raises(InputError, match=r"a\.npz: the archive is damaged"):
        read_clip(path)


def test_a_zip_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("motion.formats.archives.LARGEST", 2**21)
    path = tmp_path / "bomb.npz"
    np.savez_compressed(path, poses=np.zeros(2**21, np.float32))
    assert path.stat().st_size < 2**16
    with pytest.raises(InputError, match=r"bomb\.npz: the archive unpacks to 8 MiB, more than 2"):
        read_clip(path)


def test_the_frame_rate_is_read_without_the_motion_and_validated(tmp_path: Path) -> None:
    path = save(tmp_path / "a.npz", mocap_frame_rate=24.0, poses=np.zeros(1))
    assert read_frame_rate(path) == 24.0
    save(path, mocap_frame_rate=0.0)
    with pytest.raises(InputError, match=r"a\.npz: frame rate 0 is not usable"):
        read_frame_rate(path)
