from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from analysis.evaluators.evaluator import load_evaluator
from motion.formats import write_clip
from tests.analysis.evaluators.swinging import SWINGS, swinging
from tests.support.command_line import run
from tests.support.short_training import short_training
from training.device import torch_threads


@pytest.fixture(scope="module", autouse=True)
def one_thread() -> Iterator[None]:
    with torch_threads(1):
        yield


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return ten clips of two emotions, and one that is damaged."""
    folder = tmp_path_factory.mktemp("recorded")
    rows = ["name,emotion"]
    for emotion in SWINGS:
        for seed in range(5):
            write_clip(folder / f"{emotion}{seed}.npz", swinging(emotion, seed))
            rows.append(f"{emotion}{seed},{emotion}")
    (folder / "cut.npz").write_bytes(b"cut")
    (folder / "segments.csv").write_text("\n".join([*rows, "cut,anger"]))
    return folder


def test_a_network_is_trained_and_damaged_files_are_counted(recorded: Path, tmp_path: Path) -> None:
    out = tmp_path / "new" / "m.safetensors"
    given = ("emotion", "--data", recorded, "--config", "tiny", "--steps", 12, "--out", out)
    shown = run("train", "evaluator", *given)
    assert f"skipped: {recorded / 'cut.npz'}" in shown
    assert "1 clip skipped." in shown
    assert "Learned from 40 windows of 10 clips; held out 2 of 10 recordings" in shown
    assert "Accuracy on held-out data with 2 emotions: 1.000" in shown
    assert f"Wrote {out}" in shown
    assert load_evaluator(out).labels == ("anger", "sadness")
    assert (tmp_path / "new" / "m.run" / "curves.png").stat().st_size > 1000


@short_training()
def test_a_network_that_learned_nothing_is_reported(recorded: Path, tmp_path: Path) -> None:
    given = ("motion", "--data", recorded, "--config", "tiny", "--steps", 1, "--seed", 3)
    shown = run("train", "evaluator", *given, "--out", tmp_path / "m.safetensors")
    assert "The network is no better than that baseline" in shown
