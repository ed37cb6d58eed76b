"""Features of takes are computed once, and only broken takes are skipped."""

import errno
import os
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pyarrow
import pytest

from motion.errors import InputError
from tests.training.data.recordings import counting
from tests.training.takes import take_named
from training.data.feature_cache import PreparedTakes, prepare
from training.data.take import Feature, Take, TakeFolder

RATE = 15.0


def takes_in(folder: Path, number: int = 4) -> TakeFolder:
    """Return takes whose sound contains a digit, from which features are made."""
    folder.mkdir()
    result = []
    for index in range(number):
        name = f"take{index:02}"
        for ending in (".wav", ".bvh"):
            (folder / f"{name}{ending}").write_text(str(index))
        result.append(take_named(name, folder))
    return TakeFolder(kind="beat", takes=tuple(result), speakers=("scott",))


@pytest.fixture
def takes(tmp_path: Path) -> TakeFolder:
    return takes_in(tmp_path / "data")


def digit(take: Take) -> np.ndarray:
    return np.full((30, 2), float(take.speech.read_text()))


def prepared(takes: TakeFolder, cache: Path, *features: Feature) -> PreparedTakes:
    return prepare(takes, features, cache, frame_rate=RATE)


def test_features_are_computed_once_without_leaving_files_open(
    takes: TakeFolder, tmp_path: Path
) -> None:
    feature, asked = counting("digit", digit)
    first = prepared(takes, tmp_path / "cache", feature)
    open_files = len([*Path("/proc/self/fd").iterdir()])
    again = prepared(takes, tmp_path / "cache", feature)
    assert len([*Path("/proc/self/fd").iterdir()]) == open_files
    assert asked == ["take00", "take01", "take02", "take03"]
    assert again.sha256 == first.sha256
    for index, values in enumerate(again.arrays["digit"]):
        np.testing.assert_array_equal(values, np.full((30, 2), index, np.float32))
        assert not values.flags.writeable


def test_no_usable_take_and_an_unwritable_cache_are_errors(
    takes: TakeFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    flat, _ = counting("digit", lambda take: np.zeros(3))
    with pytest.raises(InputError, match=r"none of the 4 takes.*take00: its digit has shape \(3,"):
        prepared(takes, tmp_path / "cache", flat)
    (tmp_path / "file").write_text("a file")
    feature, _ = counting("digit", digit)
    with pytest.raises(InputError, match=r"features cannot be stored \(Not a directory\)"):
        prepared(takes, tmp_path / "file", feature)
    full = Mock(side_effect=OSError(errno.ENOSPC, "No space left on device"))
    monkeypatch.setattr(pyarrow.ipc, "write_tensor", full)
    with pytest.raises(InputError, match=r"features cannot be stored \(No space left on device"):
        prepared(takes, tmp_path / "cache", feature)


def test_another_version_rate_or_file_is_recomputed(takes: TakeFolder, tmp_path: Path) -> None:
    feature, asked = counting("digit", digit)
    newer, asked_newer = counting("digit", digit, version="2")
    cache = tmp_path / "cache"
    before = prepared(takes, cache, feature)
    prepared(takes, cache, newer)
    assert len(asked_newer) == 4
    prepare(takes, [feature], cache, frame_rate=30)
    assert len(asked) == 8
    # Neither its size nor its time of writing tells that this file is another.
    changed = takes.takes[2].speech
    written = changed.stat().st_mtime_ns
    changed.write_text("7")
    os.utime(changed, ns=(written, written))
    after = prepared(takes, cache, feature)
    assert asked[8:] == ["take02"]
    assert after.sha256 != before.sha256
    assert after.arrays["digit"][2][0, 0] == 7


def test_a_copied_data_set_or_cache_is_not_recomputed(takes: TakeFolder, tmp_path: Path) -> None:
    feature, asked = counting("digit", digit)
    first = prepared(takes, tmp_path / "cache", feature)
    os.utime(takes.takes[0].speech, (1, 1))
    shutil.copytree(tmp_path / "cache", tmp_path / "copy")
    for result in (takes, takes_in(tmp_path / "elsewhere")):
        assert prepared(result, tmp_path / "copy", feature).sha256 == first.sha256
    assert len(asked) == 4


def test_a_cached_feature_that_was_cut_off_is_named(takes: TakeFolder, tmp_path: Path) -> None:
    feature, _ = counting("digit", digit)
    prepared(takes, tmp_path / "cache", feature)
    cut = min((tmp_path / "cache").rglob("*.tensor"))
    cut.write_bytes(cut.read_bytes()[:100])
    (error,) = prepared(takes, tmp_path / "cache", feature).skipped
    assert f"{cut}: take take00: the cached feature cannot be read. Delete the file" in str(error)


def test_a_bad_take_is_named_and_skipped(takes: TakeFolder, tmp_path: Path) -> None:
    def compute(take: Take) -> np.ndarray:
        values = digit(take)
        if take.name == "take00":
            raise InputError("the motion is broken", where=take.motion, remedy="Copy it again")
        if take.name == "take01":
            values[3, 1] = np.nan
        return values[:0] if take.name == "take02" else values

    feature, _ = counting("digit", compute)
    result = prepared(takes, tmp_path / "cache", feature)
    assert [take.name for take in result.takes] == ["take03"]
    broken, nan, empty = map(str, result.skipped)
    assert "take00.bvh: take take00: the motion is broken. Copy it again." in broken
    assert "take01: its digit is not a number at frame 3, channel 1" in nan
    assert "take02: its digit has shape (0, 2)" in empty


def test_sound_and_motion_of_different_lengths_are_refused(
    takes: TakeFolder, tmp_path: Path
) -> None:
    longer = {"take00": 7, "take01": 8}
    motion, _ = counting("motion", lambda take: np.zeros((30 + longer.get(take.name, 0), 3)))
    sound, asked = counting("sound", digit)
    costly, asked_costly = counting("costly", digit)
    result = prepared(takes, tmp_path / "cache", motion, sound, costly)
    assert [take.name for take in result.takes] == ["take00", "take02", "take03"]
    assert len(asked) == 4
    assert "take01" not in asked_costly
    assert "motion lasts 2.53 s and sound 2.00 s, more than 0.5 s apart" in str(result.skipped[0])
    assert {len(result.arrays[name][0]) for name in result.arrays} == {30}


def test_stopping_keeps_finished_takes_and_no_partial_files(
    takes: TakeFolder, tmp_path: Path
) -> None:
    def stopped(take: Take) -> np.ndarray:
        if take.name == "take02":
            raise KeyboardInterrupt
        return digit(take)

    interrupted, _ = counting("digit", stopped)
    with pytest.raises(KeyboardInterrupt):
        prepared(takes, tmp_path / "cache", interrupted)
    feature, asked = counting("digit", digit)
    prepared(takes, tmp_path / "cache", feature)
    assert asked == ["take02", "take03"]
    assert not list((tmp_path / "cache").rglob(".*"))


def test_several_processes_share_the_work(tmp_path: Path) -> None:
    takes = takes_in(tmp_path / "data", 12)
    feature, asked = counting("digit", digit)
    with ThreadPoolExecutor(4) as pool:
        result = list(pool.map(lambda _: prepared(takes, tmp_path / "cache", feature), range(4)))
    assert sorted(asked) == [take.name for take in takes.takes]
    assert len({one.sha256 for one in result}) == 1
