from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from motion.body.archive import read_mean_hands
from motion.errors import InputError


def test_mean_hands_of_a_licensed_file_are_left_then_right(tmp_path: Path) -> None:
    left, right = np.arange(45.0), -np.arange(45.0)
    np.savez(tmp_path / "a.npz", hands_meanl=left, hands_meanr=right)
    hands = read_mean_hands(tmp_path / "a.npz")
    assert hands is not None
    np.testing.assert_array_equal(hands.reshape(2, 45), [left, right])


@pytest.mark.parametrize("arrays", [{}, {"hands_meanl": np.zeros(45), "hands_meanr": np.zeros(45)}])
def test_file_without_mean_hands_gives_none(tmp_path: Path, arrays: dict[str, Any]) -> None:
    np.savez(tmp_path / "a.npz", **arrays)
    assert read_mean_hands(tmp_path / "a.npz") is None


def test_garbled_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_text("hello")
    with pytest.raises(InputError, match=r"a\.npz: .* cannot be read"):
        read_mean_hands(tmp_path / "a.npz")
