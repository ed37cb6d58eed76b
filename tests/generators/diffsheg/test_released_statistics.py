"""Means and deviations as the authors released them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from generators.diffsheg.config import BEAT
from generators.diffsheg.released import read_normalisation
from motion.errors import InputError

SMALL = replace(BEAT, gesture_width=3, expression_width=2)
FILES = {
    "axis_angle_mean": [0.0, 1.0, 2.0],
    "axis_angle_std": [1.0, 0.0, 2.3e-8],
    "json_mean": [0.1, 0.2],
    "json_std": [0.5, 0.25],
}


@pytest.fixture
def stats(tmp_path: Path) -> Path:
    for name, values in FILES.items():
        np.save(tmp_path / f"{name}.npy", np.array(values))
    return tmp_path


def test_the_bodys_values_come_first_and_then_the_faces(stats: Path) -> None:
    found = read_normalisation(stats, SMALL)
    assert found.mean.tolist() == [0.0, 1.0, 2.0, 0.1, 0.2]
    assert found.std.tolist() == [1.0, 0.0, 2.3e-8, 0.5, 0.25]


def test_the_faces_files_may_lie_in_a_folder_of_their_own(stats: Path) -> None:
    expected = read_normalisation(stats, SMALL)
    (stats / "facial52").mkdir()
    for name in ("json_mean.npy", "json_std.npy"):
        (stats / name).rename(stats / "facial52" / name)
    assert read_normalisation(stats, SMALL).mean.tolist() == expected.mean.tolist()


def test_a_value_that_never_changes_stays_at_its_mean(stats: Path) -> None:
    known = read_normalisation(stats, SMALL)
    motion = known.restored(np.full((4, 5), 100.0))
    assert (motion[:, 1] == 1.0).all()
    assert (motion[:, 2] == 2.0).all()
    assert (known.normalised(motion)[:, 1:3] == 0).all()


@pytest.mark.parametrize("name", sorted(FILES))
def test_a_missing_file_is_named(stats: Path, name: str) -> None:
    (stats / f"{name}.npy").unlink()
    with pytest.raises(InputError, match="no such file") as refusal:
        read_normalisation(stats, SMALL)
    assert f"{name}.npy" in str(refusal.value)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (np.zeros(4), "shape"),
        (np.array([0.0, np.nan, 0.0]), "finite"),
        (np.array([None] * 3, dtype=object), "plain array"),
        (np.array([-1.0, 0.0, 0.0]), "negative"),
    ],
    ids=["another size", "not a number", "pickled", "negative"],
)
def test_unusable_content_is_refused(stats: Path, values: np.ndarray, said: str) -> None:
    np.save(stats / "axis_angle_std.npy", values, allow_pickle=True)
    with pytest.raises(InputError, match=said):
        read_normalisation(stats, SMALL)
