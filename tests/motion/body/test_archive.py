from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from motion.body.archive import body_archive
from motion.errors import InputError


def _empty(path: Path) -> None:
    path.touch()


def _single_array(path: Path) -> None:
    with path.open("wb") as file:
        np.save(file, np.zeros(3))


def _text(path: Path) -> None:
    path.write_text("hello")


def _truncated(path: Path) -> None:
    np.savez_compressed(path, f=np.arange(9000))
    path.write_bytes(path.read_bytes()[:500])


def _overwritten(path: Path) -> None:
    np.savez_compressed(path, f=np.random.default_rng(0).normal(size=9000))
    content = bytearray(path.read_bytes())
    content[1000:3000] = bytes(2000)
    path.write_bytes(content)


def _code(path: Path) -> None:
    np.savez(path, f=np.array([{"a": 1}], dtype=object))


@pytest.mark.parametrize("damage", [_empty, _single_array, _text, _truncated, _overwritten, _code])
def test_a_damaged_body_is_refused_by_name(tmp_path: Path, damage: Callable[[Path], None]) -> None:
    path = tmp_path / "body.npz"
    damage(path)
    with (
        pytest.raises(InputError, match=r"body\.npz: the file cannot be read as a body model"),
        body_archive(path) as archive,
    ):
        archive["f"]


def test_a_missing_body_and_a_folder_are_told(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "gone.npz"):
        with pytest.raises(InputError, match="there is no such body model"), body_archive(path):
            pass


def test_arrays_are_given_by_name(tmp_path: Path) -> None:
    np.savez(tmp_path / "body.npz", f=np.arange(3))
    with body_archive(tmp_path / "body.npz") as archive:
        assert archive.files == ["f"]
        np.testing.assert_array_equal(archive["f"], np.arange(3))
