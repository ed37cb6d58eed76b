from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from analysis.measurement.kept_arrays import KeptArrays, Kind, forget_unused
from analysis.measurement.measured_clips import Reader, SeenMotion, Setup
from analysis.measurement.presets import Preset
from motion.arrays import Floats32
from motion.clip import MotionClip
from motion.formats import write_clip
from motion.formats.beat_tracks import write_arkit_json

JOINTS = Kind("joints", "1", (None, 2))
OLDER = Kind("joints", "0", (None, 2))
OTHER = Kind("features", "1", (None, None))


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "motion.npz"
    path.write_bytes(b"some motion")
    return path


def computed(
    folder: Path | None, source: Path, kind: Kind = JOINTS, settings: str = "30 fps"
) -> tuple[bool, KeptArrays]:
    """Return whether an array had to be computed, and its cache key."""
    kept, calls = KeptArrays(folder), []

    def compute() -> Floats32:
        calls.append(1)
        return np.ones((3, 2), np.float32)

    found = kept.array(kind, (source,), settings, compute)
    assert found.tolist() == [[1, 1]] * 3
    return bool(calls), kept


def test_an_array_is_computed_once_per_content_settings_kind_and_version(
    tmp_path: Path, source: Path
) -> None:
    folder = tmp_path / "kept"
    for kind, settings in ((JOINTS, "a"), (JOINTS, "b"), (OLDER, "a"), (OTHER, "a")):
        assert computed(folder, source, kind, settings)[0]
        assert not computed(folder, source, kind, settings)[0]
    source.write_bytes(b"another motion")
    assert computed(folder, source, JOINTS, "a")[0]
    copied = source.with_name("copy.npz")
    copied.write_bytes(b"some motion")
    assert not computed(folder, copied, JOINTS, "a")[0]


@pytest.mark.parametrize("damaged", [b"", b"\x93NUMPY", b"no array at all"])
def test_damaged_or_mismatched_files_are_computed_again(
    tmp_path: Path, source: Path, damaged: bytes
) -> None:
    folder = tmp_path / "kept"
    (place,) = computed(folder, source)[1].used
    place.write_bytes(damaged)
    assert computed(folder, source)[0]
    place.write_bytes(place.read_bytes()[:-1])
    assert computed(folder, source)[0]
    for other in (np.ones((3, 4), np.float32), np.ones(3, np.float32), np.ones((3, 2))):
        np.save(place, other)
        assert computed(folder, source)[0]


def test_only_unused_files_are_removed(tmp_path: Path, source: Path) -> None:
    folder = tmp_path / "kept"

    def place(kind: Kind, settings: str) -> Path:
        return next(iter(computed(folder, source, kind, settings)[1].used))

    beside, other_kind = place(JOINTS, "b"), place(OTHER, "a")
    place(OLDER, "a")
    place(JOINTS, "a")
    (folder / ".draft.npy").write_bytes(b"")
    source.write_bytes(b"another motion")
    used = place(JOINTS, "a")
    forget_unused({used})
    assert set(folder.iterdir()) == {used, beside, other_kind, folder / ".draft.npy"}


def test_an_unwritable_cache_folder_is_harmless(tmp_path: Path, source: Path) -> None:
    (tmp_path / "kept").write_text("a file, not a folder")
    assert computed(tmp_path / "kept", source)[0]
    assert computed(tmp_path / "kept", source)[0]
    assert computed(None, source)[0]


def test_motion_its_face_file_rate_and_frozen_channels_are_part_of_the_cache_key(
    tmp_path: Path, waving: Callable[..., MotionClip]
) -> None:
    def place(rate: float, *frozen: str, own_files: bool = True) -> Path:
        setup = Setup(
            frame_rate=rate,
            motion=SeenMotion(frozen=frozen, own_files=own_files),
            preset=Preset(),
            kept=tmp_path / "kept",
        )
        reader = Reader(setup)
        assert reader.clip(path) is not None
        return next(iter(reader.kept.used))

    places = set()
    path = tmp_path / "a.npz"
    for size in (0.4, 0.5):
        write_clip(path, waving(amplitude=size, seconds=0.5))
        for rate in (15.0, 30.0):
            places |= {place(rate), place(rate, "face"), place(rate, "face", "hands")}
    assert len(places) == 2 * 2 * 3
    assert place(30.0, "hands", "face") in places
    of_others = set()
    for weight in (0.2, 0.7):
        write_arkit_json(tmp_path / "a.json", np.full((15, 51), weight), 30)
        of_others.add(place(30.0, own_files=False))
    assert len(of_others) == 2
