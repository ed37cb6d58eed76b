from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from training.run.curves import draw_curves
from training.run.records import RunLog


def grown(path: Path, upto: int) -> RunLog:
    """Return a log saved after every second step; every third is followed by a measurement."""
    log = RunLog(path, steps=0)
    for step in range(1, upto + 1):
        log.add({"step": step, "learning_rate": 0.1, "loss": 1 / step})
        if step % 3 == 0:
            log.add({"step": step, "held_out": {"loss": 2 / step}})
        if step % 2 == 0:
            log.save()
    log.save()
    return log


@pytest.mark.parametrize("tail", ["", '{"step": 7, "lo', "\x00\x00", '{"step": 7, "loss": 1}'])
def test_steps_that_a_crash_lost_are_cut_off_when_the_run_goes_on(
    tail: str, tmp_path: Path
) -> None:
    whole, path = tmp_path / "whole.jsonl", tmp_path / "log.jsonl"
    lines = grown(whole, 6).lines
    grown(path, 6)
    assert RunLog(whole, steps=6).lines == lines
    assert [json.loads(line) for line in whole.read_text().splitlines()] == lines
    with path.open("a") as file:
        file.write(tail)
    before = path.read_bytes()
    log = RunLog(path, steps=4)
    assert path.read_bytes() == before
    for line in lines[len(log.lines) :]:
        log.add(line)
    log.save()
    assert path.read_bytes() == whole.read_bytes()


@pytest.mark.parametrize("steps", [1, 40, 3000])
def test_equal_logs_make_equal_pictures_with_held_out_measures(steps: int, tmp_path: Path) -> None:
    learned: list[dict[str, object]] = [
        {"step": step, "learning_rate": 0.1, "loss": 5 / step, "noise": -1.0}
        for step in range(1, steps + 1)
    ]
    held_out = [{"step": step, "held_out": {"loss": 6 / step}} for step in range(10, steps, 10)]
    pictures = [tmp_path / name for name in ("1.png", "2.png")]
    for path in pictures:
        draw_curves([*learned, *held_out], path)
    assert pictures[0].read_bytes() == pictures[1].read_bytes()
    with Image.open(pictures[0]) as picture:
        assert picture.size == (900, 620)
        pixels = np.asarray(picture.convert("RGB"))
    assert (pixels == (0xB3, 0x54, 0x1E)).all(axis=2).any() == bool(held_out)
