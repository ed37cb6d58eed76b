"""Folders of recordings, as researchers have them."""

import json
import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from motion.errors import InputError
from motion.skeleton import joint_index
from tests.training.data.recordings import (
    beat_take,
    touch,
    write_clicks,
    write_show,
    write_smplx,
    write_ted,
)
from training.data.folders import read_takes
from training.data.take import TakeFolder
from training.features import read_smplx


def smplx_take(folder: Path, name: str) -> None:
    write_smplx(folder / f"{name}.npz", 1)
    write_clicks(folder / f"{name}.wav", 1)


def said(takes: TakeFolder) -> list[str]:
    return [str(error) for error in takes.skipped]


def test_beat_is_read_as_downloaded(tmp_path: Path) -> None:
    beat_take(tmp_path / "2", "2_scott_0_9_9", ".json", ".txt", ".csv", ".TextGrid")
    beat_take(tmp_path / "10", "10_kieks_0_66_66")
    result = read_takes(tmp_path)
    assert result.kind == "beat"
    assert result.speakers == ("scott", "kieks")
    assert [take.name for take in result.takes] == ["10_kieks_0_66_66", "2_scott_0_9_9"]
    kieks, scott = result.takes
    assert (scott.emotion, kieks.emotion) == ("neutral", "happiness")
    assert scott.face == tmp_path / "2" / "2_scott_0_9_9.json"
    assert scott.semantic == tmp_path / "2" / "2_scott_0_9_9.txt"
    assert scott.transcript == tmp_path / "2" / "2_scott_0_9_9.TextGrid"
    assert kieks.transcript is None
    assert kieks.face is None
    assert not result.skipped


def test_incomplete_takes_of_beat_are_named_and_skipped(tmp_path: Path) -> None:
    beat_take(tmp_path, "2_scott_0_9_9")
    beat_take(tmp_path / "again", "2_scott_0_9_9")
    touch(tmp_path / "2_scott_0_10_10.bvh", tmp_path / "2_scott_0_11_11.wav")
    beat_take(tmp_path, "a walk")
    beat_take(tmp_path, "2_scott_0_12_12")
    (tmp_path / "2_scott_0_12_12.wav").write_bytes(b"")
    result = read_takes(tmp_path)
    assert [take.motion for take in result.takes] == [tmp_path / "2_scott_0_9_9.bvh"]
    messages = {
        "2_scott_0_10_10.bvh: the motion has no sound": "Put 2_scott_0_10_10.wav next to it",
        "2_scott_0_11_11.wav: the sound has no motion": "Put 2_scott_0_11_11.bvh next to it",
        "2_scott_0_12_12.bvh: the motion or its sound is empty": "Copy both again",
        "a walk.bvh: the file's name is not in BEAT's format": "such as 2_scott_0_9_9",
        "again/2_scott_0_9_9.bvh: take 2_scott_0_9_9 exists twice": "Rename or remove",
    }
    assert len(result.skipped) == len(messages)
    for what, remedy in messages.items():
        assert any(what in text and remedy in text for text in said(result)), what


def test_hidden_files_are_skipped_and_folder_links_followed_once(tmp_path: Path) -> None:
    beat_take(tmp_path / "disk", "2_scott_0_9_9")
    touch(tmp_path / "disk" / "._2_scott_0_9_9.bvh")
    touch(tmp_path / "disk" / ".cache" / "2_scott_0_10_10.bvh")
    (tmp_path / "data").mkdir()
    (tmp_path / "data" / "2").symlink_to(tmp_path / "disk")
    (tmp_path / "disk" / "back").symlink_to(tmp_path / "data")
    result = read_takes(tmp_path / "data")
    assert [take.name for take in result.takes] == ["2_scott_0_9_9"]
    assert not result.skipped


def test_beat2_is_read_as_downloaded(tmp_path: Path) -> None:
    write_smplx(tmp_path / "smplxflame_30" / "2_scott_0_65_65.npz", 1)
    write_clicks(tmp_path / "wave16k" / "2_scott_0_65_65.wav", 1)
    touch(tmp_path / "sem" / "2_scott_0_65_65.txt", tmp_path / "textgrid" / "x.TextGrid")
    np.savez(tmp_path / "weights.npz", mean=np.zeros(3))
    result = read_takes(tmp_path)
    assert result.kind == "beat2"
    (take,) = result.takes
    assert (take.speaker, take.emotion, take.split) == ("scott", "happiness", "test")
    assert take.speech == tmp_path / "wave16k" / "2_scott_0_65_65.wav"
    assert take.semantic == tmp_path / "sem" / "2_scott_0_65_65.txt"
    assert not result.skipped


def test_smplx_folders_are_speakers_and_damaged_archives_are_skipped(tmp_path: Path) -> None:
    for speaker in ("anna", "ben"):
        for name in ("talks well", "bad", "other"):
            smplx_take(tmp_path / speaker, f"{speaker} {name}")
        bad = tmp_path / speaker / f"{speaker} bad.npz"
        bad.write_bytes(bad.read_bytes()[:1000])
        np.savez(tmp_path / speaker / f"{speaker} other.npz", trans=np.zeros((3, 3)))
    result = read_takes(tmp_path)
    assert [take.speaker for take in result.takes] == list(result.speakers) == ["anna", "ben"]
    assert all(" " not in take.name for take in result.takes)
    unusable = [f"{speaker} {name}.npz" for speaker in ("anna", "ben") for name in ("bad", "other")]
    for name, message in zip(unusable, said(result), strict=True):
        assert f"{name}: the file is damaged, or holds none of the arrays poses" in message


def show_clip(folder: Path, *, motion: bool = True) -> None:
    """Write a clip as TalkSHOW lays it out: a folder that holds files of its name."""
    if motion:
        write_show(folder / f"{folder.name}.npy", 1)
    write_clicks(folder / f"{folder.name}.wav", 1)


def test_show_is_read_in_talkshows_layout(tmp_path: Path) -> None:
    for split in ("train", "val", "test"):
        show_clip(tmp_path / "oliver" / "A talk (2020)" / split / f"{split}-00_01-00_02")
    result = read_takes(tmp_path)
    assert result.kind == "show"
    assert {take.motion.stem: take.split for take in result.takes} == {
        "train-00_01-00_02": "train",
        "val-00_01-00_02": "validation",
        "test-00_01-00_02": "test",
    }
    assert result.speakers == ("oliver",)
    assert "1 recording cut into takes of several splits" in result.notes[1]


def test_without_split_folders_clips_of_one_video_share_a_split(tmp_path: Path) -> None:
    for video in range(6):
        for clip in range(3):
            show_clip(tmp_path / "oliver" / f"video {video}" / f"{video}-{clip}")
    splits: dict[str, set[str]] = {}
    for take in read_takes(tmp_path).takes:
        splits.setdefault(take.motion.parent.parent.name, set()).add(take.split)
    assert all(len(of_video) == 1 for of_video in splits.values())
    assert set.union(*splits.values()) == {"train", "validation", "test"}


def test_shows_own_list_of_splits_is_understood(tmp_path: Path) -> None:
    for clip in ("1-00_01", "2-00_02"):
        show_clip(tmp_path / "oliver" / "A talk.webm" / clip)
    (tmp_path / "train_val_test.json").write_text(
        '{"train": ["oliver/A talk.webm/1-00_01"], "val": ["oliver/A talk.webm/2-00_02"],'
        ' "test": ["seth/Gone.webm/3-00_03"]}'
    )
    result = read_takes(tmp_path)
    assert [take.split for take in result.takes] == ["train", "validation"]
    assert any("1 name (seth/Gone.webm/3-00_03) of the list not found" in n for n in result.notes)


def test_pickles_are_never_opened_and_the_conversion_is_explained(tmp_path: Path) -> None:
    class Trap:
        def __reduce__(self) -> tuple[object, tuple[Path]]:
            return Path.touch, (tmp_path / "sprung",)

    clip = tmp_path / "oliver" / "video" / "00_01"
    show_clip(clip, motion=False)
    (clip / "00_01.pkl").write_bytes(pickle.dumps(Trap()))
    with pytest.raises(InputError, match=r"docs/data\.md.*pickled"):
        read_takes(tmp_path)
    show_clip(tmp_path / "oliver" / "video" / "00_02")
    result = read_takes(tmp_path)
    assert len(result.takes) == 1
    assert "00_01.wav: the sound has no motion" in said(result)[0]
    assert not (tmp_path / "sprung").exists()


def test_ted_is_read_from_arrays_by_split_and_talk_not_from_its_database(tmp_path: Path) -> None:
    touch(tmp_path / "lmdb_train" / "data.mdb", tmp_path / "lmdb_train" / "lock.mdb")
    with pytest.raises(InputError, match=r"docs/data\.md.*pickled"):
        read_takes(tmp_path)
    for split, talk in (("train", "talk1"), ("val", "talk2"), ("test", "talk3")):
        write_ted(tmp_path / split / talk / "0.npz", 1)
        write_clicks(tmp_path / split / talk / "0.wav", 1)
    result = read_takes(tmp_path)
    assert result.kind == "ted"
    assert result.speakers == ("talk1", "talk2", "talk3")
    assert [take.split for take in result.takes] == ["train", "validation", "test"]


def test_a_folder_with_several_layouts_is_refused(tmp_path: Path) -> None:
    smplx_take(tmp_path, "a")
    write_show(tmp_path / "b.npy", 1)
    write_clicks(tmp_path / "b.wav", 1)
    with pytest.raises(InputError, match="may be beat2 and show"):
        read_takes(tmp_path)


def test_folders_without_recordings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        read_takes(tmp_path / "gone")
    with pytest.raises(InputError, match="no recordings of a known layout"):
        read_takes(tmp_path)
    touch(tmp_path / "a.bvh")
    with pytest.raises(InputError, match="holds no take of beat"):
        read_takes(tmp_path)


DOCS = Path(__file__).parents[3] / "docs" / "data.md"


def script(name: str) -> str:
    blocks: list[str] = re.findall(
        r"```python\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL
    )
    return next(block for block in blocks if block.startswith(f"# python {name}"))


def test_the_documented_script_converts_shows_pickles_to_takes(tmp_path: Path) -> None:
    frames, clip = 5, tmp_path / "show" / "oliver" / "talk.webm" / "00_01" / "00_01.pkl"
    write_clicks(clip.with_suffix(".wav"), frames / 30)
    rng = np.random.default_rng(1)
    arrays = {
        "jaw_pose": rng.normal(size=(frames, 3)),
        "leye_pose": np.zeros((frames, 3)),
        "reye_pose": np.zeros((frames, 3)),
        "global_orient": np.zeros((frames, 1, 3)),
        "body_pose_axis": rng.normal(size=(frames, 21, 3)),
        "left_hand_pose": rng.normal(size=(frames, 12)),
        "right_hand_pose": rng.normal(size=(frames, 12)),
        "expression": rng.normal(size=(frames, 100)),
        "betas": np.zeros(300),
    }
    clip.write_bytes(pickle.dumps({**arrays, "batch_size": frames}))
    hands = {side: rng.normal(size=(45, 45)).tolist() for side in ("left", "right")}
    (tmp_path / "hands.json").write_text(json.dumps(hands))
    command = [sys.executable, "-c", script("show_to_npy.py")]
    subprocess.run([*command, tmp_path / "show", tmp_path / "hands.json"], check=True)
    result = read_takes(tmp_path / "show")
    assert not result.skipped
    motion = read_smplx(result.takes[0])
    np.testing.assert_allclose(
        motion.poses[:, joint_index("right_index1")],
        (arrays["right_hand_pose"] @ np.array(hands["right"])[:12])[:, :3],
        rtol=1e-5,
    )
    assert motion.expressions is not None
    np.testing.assert_allclose(motion.expressions, arrays["expression"], rtol=1e-6)
