from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from training.run.curves import draw_curves


def lines(steps: int) -> list[dict[str, object]]:
    found: list[dict[str, object]] = []
    for step in range(1, steps + 1):
        found.append({"step": step, "learning_rate": 0.1, "loss": 5 / step, "noise": -1.0})
        if step % 10 == 0:
            found.append({"step": step, "held_out": {"loss": 6 / step, "accuracy": 0.5}})
    return found


@pytest.mark.parametrize("steps", [1, 3000])
def test_equal_logs_make_equal_pictures_of_the_same_size(steps: int, tmp_path: Path) -> None:
    for name in ("1.png", "2.png"):
        draw_curves(lines(steps), tmp_path / name)
    assert (tmp_path / "1.png").read_bytes() == (tmp_path / "2.png").read_bytes()
    with Image.open(tmp_path / "1.png") as picture:
        assert picture.size == (900, 620)


def test_what_was_measured_of_held_out_examples_is_seen(tmp_path: Path) -> None:
    learned = [line for line in lines(40) if "held_out" not in line]
    seen = {}
    for name, shown in (("all", lines(40)), ("learned", learned)):
        draw_curves(shown, tmp_path / f"{name}.png")
        with Image.open(tmp_path / f"{name}.png") as picture:
            pixels = np.asarray(picture.convert("RGB"))
        seen[name] = int((pixels == (0xB3, 0x54, 0x1E)).all(axis=2).sum())
    assert seen["learned"] == 0
    assert seen["all"] > 100
