from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.formats import read_clip, read_motion, write_clip
from motion.formats.bvh_motion import write_clip_bvh
from motion.skeleton import FINGERS, RELAXED_HANDS, REST_JOINTS, joint_index
from tests.motion.formats.bvh_text import CHAIN, bvh_text, save_bvh_text
from tests.motion.random_clips import assert_same_clip, clip_of


def person_bvh(path: Path, frames: int | None = None) -> Path:
    poses = np.zeros((2, 55, 3))
    poses[:, joint_index("left_elbow"), 2] = np.radians([10, 20])
    write_clip_bvh(path, clip_of(poses), REST_JOINTS)
    text = path.read_text()
    return save_bvh_text(path, text.replace("Frames: 2", f"Frames: {frames}") if frames else text)


@pytest.mark.parametrize("ending", ["bvh", "npz"])
def test_the_format_follows_the_content_not_the_extension(tmp_path: Path, ending: str) -> None:
    path = person_bvh(tmp_path / f"a.{ending}")
    clip = read_motion(path)
    elbow = np.degrees(clip.poses[:, joint_index("left_elbow")])
    np.testing.assert_allclose(elbow, [[0, 0, 10], [0, 0, 20]], atol=1e-4)
    assert clip.provenance["source"] == path.name
    assert clip.provenance["format"] == "bvh (smplx)"


def test_npz_files_of_others_are_placed_with_a_note(tmp_path: Path) -> None:
    poses = np.zeros((4, 165))
    poses[:, 0] = np.pi / 2
    np.savez(tmp_path / "amass.npz", poses=poses, trans=np.ones((4, 3)), mocap_framerate=120)
    clip = read_motion(tmp_path / "amass.npz")
    np.testing.assert_allclose(clip.poses[:, : FINGERS.start], 0, atol=1e-6)
    np.testing.assert_allclose(clip.trans, 0, atol=1e-6)
    assert clip.provenance["source"] == "amass.npz"
    assert clip.provenance["format"] == "npz"
    assert clip.provenance["notes"].endswith("z was up; turned to y up")
    np.testing.assert_allclose(read_clip(tmp_path / "amass.npz").poses[:, 0, 0], np.pi / 2)


@pytest.mark.parametrize("kind", ["talkshow", "npz (BEAT2)"])
def test_fingers_relative_to_the_mean_hands_become_absolute(tmp_path: Path, kind: str) -> None:
    path = tmp_path / ("a.npy" if kind == "talkshow" else "a.npz")
    if kind == "talkshow":
        np.save(path, np.zeros((3, 265)))
    else:
        np.savez(path, poses=np.zeros((3, 165)), mocap_frame_rate=30, model="smplx2020")
    clip = read_motion(path)
    assert clip.provenance["format"] == kind
    assert "relaxed hands took their place" in clip.provenance["notes"]
    np.testing.assert_allclose(clip.poses[2, FINGERS], RELAXED_HANDS, atol=1e-6)
    mean = np.full((30, 3), 0.2, np.float32)
    licensed = read_motion(path, mean_hands=mean)
    assert "taken from the licensed model" in licensed.provenance["notes"]
    np.testing.assert_allclose(licensed.poses[2, FINGERS], mean, atol=1e-6)


def test_fingers_of_our_own_files_and_amass_are_kept(tmp_path: Path) -> None:
    poses = np.full((3, 165), 0.01)
    np.savez(tmp_path / "amass.npz", poses=poses, mocap_framerate=30)
    clip = read_motion(tmp_path / "amass.npz", mean_hands=np.ones((30, 3), np.float32))
    np.testing.assert_allclose(clip.poses[:, 1:], 0.01, atol=1e-6)
    np.save(tmp_path / "a.npy", np.zeros((3, 265)))
    write_clip(tmp_path / "own.npz", read_motion(tmp_path / "a.npy"))
    assert_same_clip(read_motion(tmp_path / "own.npz"), read_motion(tmp_path / "a.npy"))


def test_only_missing_fingers_are_relaxed_with_a_note(tmp_path: Path) -> None:
    clip = read_motion(person_bvh(tmp_path / "a.bvh"))
    np.testing.assert_allclose(clip.poses[1, FINGERS], RELAXED_HANDS, atol=1e-6)
    assert "no finger is in the file; relaxed ones are shown" in clip.provenance["notes"]
    poses = np.zeros((3, 55, 3))
    thumb = joint_index("left_thumb2")
    poses[:, thumb] = 0.5
    np.savez(tmp_path / "a.npz", poses=poses, mocap_framerate=30)
    clip = read_motion(tmp_path / "a.npz")
    recorded = slice(thumb - 1, thumb + 2)
    np.testing.assert_allclose(clip.poses[1, recorded], poses[1, recorded])
    np.testing.assert_allclose(clip.poses[1, thumb + 2 : 55], RELAXED_HANDS[15:])
    assert "9 of 10 fingers are not in the file" in clip.provenance["notes"]


def test_frame_rate_reaches_every_reader(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.zeros((3, 265)))
    np.savez(tmp_path / "b.npz", poses=np.zeros((3, 165)))
    person_bvh(tmp_path / "c.bvh", frames=99)
    for name in ("a.npy", "b.npz", "c.bvh"):
        assert read_motion(tmp_path / name, frame_rate=15).frame_rate == 15
    assert "99 frames" in read_motion(tmp_path / "c.bvh", frame_rate=15).provenance["notes"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("words.bvh", b"nothing of the kind"),
        ("empty.npz", b""),
        ("gone.bvh", None),
        ("torn.npz", b"PK\x03\x04"),
        ("torn.npy", b"\x93NUMPY\x01"),
        ("chain.bvh", bvh_text(CHAIN, np.zeros((1, 12))).encode()),
    ],
)
def test_unusable_file_is_named(tmp_path: Path, name: str, content: bytes | None) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=name) as caught:
        read_motion(tmp_path / name)
    assert caught.value.remedy
