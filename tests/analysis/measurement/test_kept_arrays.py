from pathlib import Path

import numpy as np
import pytest

from analysis.measurement.kept_arrays import kept_array
from analysis.measurement.measured_clips import Reader, SeenMotion, Setup
from analysis.measurement.presets import Preset
from motion.arrays import Floats32
from motion.formats import write_clip
from motion.formats.beat_tracks import write_arkit_json
from tests.analysis.waving import waving


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "motion.npz"
    path.write_bytes(b"some motion")
    return path


def is_computed(
    folder: Path | None, source: Path, kind: str = "joints-1", settings: str = "30 fps"
) -> bool:
    """Return whether an array had to be computed."""
    calls = []

    def compute() -> Floats32:
        calls.append(1)
        return np.ones((3, 2), np.float32)

    assert kept_array(folder, kind, (source,), settings, compute).tolist() == [[1, 1]] * 3
    return bool(calls)


def test_an_array_is_computed_once_per_content_settings_kind_and_version(
    tmp_path: Path, source: Path
) -> None:
    folder = tmp_path / "kept"
    for kind, settings in (("joints-1", "a"), ("joints-1", "b"), ("joints-0", "a"), ("x-1", "a")):
        assert is_computed(folder, source, kind, settings)
        assert not is_computed(folder, source, kind, settings)
    source.write_bytes(b"another motion")
    assert is_computed(folder, source, settings="a")
    copied = source.with_name("copy.npz")
    copied.write_bytes(b"some motion")
    assert not is_computed(folder, copied, settings="a")


@pytest.mark.parametrize("damaged", [b"", b"\x93NUMPY", b"no array at all"])
def test_a_damaged_array_is_computed_again(tmp_path: Path, source: Path, damaged: bytes) -> None:
    folder = tmp_path / "kept"
    assert is_computed(folder, source)
    [place] = folder.iterdir()
    for content in (damaged, place.read_bytes()[:-1]):
        place.write_bytes(content)
        assert is_computed(folder, source)
        assert not is_computed(folder, source)


def test_an_unwritable_cache_folder_is_harmless(tmp_path: Path, source: Path) -> None:
    (tmp_path / "kept").write_text("a file, not a folder")
    assert is_computed(tmp_path / "kept", source)
    assert is_computed(tmp_path / "kept", source)
    assert is_computed(None, source)


def test_motion_its_face_file_rate_and_frozen_channels_are_in_the_cache_key(tmp_path: Path) -> None:
    def kept_after(rate: float, *frozen: str, own_files: bool = True) -> int:
        motion = SeenMotion(frozen=frozen, own_files=own_files)
        setup = Setup(frame_rate=rate, motion=motion, preset=Preset(), kept=tmp_path / "kept")
        Reader(setup).clip(path)
        return len(list((tmp_path / "kept").iterdir()))

    path = tmp_path / "a.npz"
    for size in (0.4, 0.5):
        write_clip(path, waving(amplitude=size, seconds=0.5))
        for rate in (15.0, 30.0):
            for frozen in ((), ("face",), ("face", "hands")):
                count = kept_after(rate, *frozen)
    assert count == kept_after(30.0, "hands", "face") == 2 * 2 * 3
    for weight in (0.2, 0.7):
        write_arkit_json(tmp_path / "a.json", np.full((15, 51), weight), 30)
        count += 1
        assert kept_after(30.0, own_files=False) == count
