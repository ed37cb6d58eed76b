from __future__ import annotations

import numpy as np
import pytest

from analysis.measurement.kept_arrays import KeptArrays
from motion.errors import InputError


@pytest.fixture
def source(tmp_path):
    path = tmp_path / "motion.npz"
    path.write_bytes(b"some motion")
    return path


def test_content_settings_kind_and_version_tell_arrays_apart(tmp_path, source):
    def place(kind="joints", version="1", settings="30 fps"):
        return KeptArrays(tmp_path, kind, version).place(source, settings)

    places = {place(), place(kind="features"), place(version="2"), place(settings="15 fps")}
    source.write_bytes(b"other motion")
    assert len(places | {place()}) == 5
    source.write_bytes(b"some motion")
    assert place() in places


def test_only_whole_arrays_of_the_right_shape_are_read(tmp_path):
    place = tmp_path / "kept.npy"
    assert KeptArrays.read(place, (None,)) is None
    KeptArrays.keep(place, np.ones((3, 2), np.float32))
    assert KeptArrays.read(place, (None, 2)).shape == (3, 2)
    assert KeptArrays.read(place, (None, 3)) is None
    assert KeptArrays.read(place, (None,)) is None
    place.write_bytes(place.read_bytes()[:-1])
    assert KeptArrays.read(place, (None, 2)) is None


def test_other_settings_and_drafts_of_runs_beside_this_one_are_left_alone(tmp_path, source):
    own, older = (KeptArrays(tmp_path / "kept", "joints", version) for version in ("2", "1"))
    unused, beside = own.place(source, "a"), own.place(source, "b")
    other_kind = KeptArrays(tmp_path / "kept", "features", "1").place(source, "a")
    draft = own.folder / ".draft.npy"
    for place in (unused, beside, other_kind, older.place(source, "a"), draft):
        KeptArrays.keep(place, np.ones(1, np.float32))
    own.forget("a", used=set())
    assert set(own.folder.iterdir()) == {beside, other_kind, draft}


def test_a_folder_that_cannot_be_written_keeps_nothing_and_stops_nobody(tmp_path):
    (tmp_path / "kept").write_text("a file, not a folder")
    KeptArrays.keep(tmp_path / "kept" / "a.npy", np.ones(1, np.float32))
    assert KeptArrays.read(tmp_path / "kept" / "a.npy", (None,)) is None


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(InputError, match=r"gone\.npz"):
        KeptArrays(tmp_path, "joints", "1").place(tmp_path / "gone.npz", "")
