"""Stopping and going on, with all that a training may hold besides weights and optimizer."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from tests.training.lines import Line, files_of_run
from training.config import Decay, TrainingConfig
from training.run.loop import train
from training.run.records import RunFolder
from training.weights_file import read_weights

PLAIN = TrainingConfig(steps=9, batch_size=8, learning_rate=0.05, validate_every=4)
CONFIGS = {
    "averaged, in parts, slower from epoch to epoch": replace(
        PLAIN, ema_decay=0.9, accumulate=3, decay=Decay(factor=0.7)
    ),
    "bfloat16": replace(PLAIN, precision="bfloat16", ema_decay=0.5),
    "float16": replace(PLAIN, precision="float16"),
}


def run(config: TrainingConfig, *stops: int) -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as name:
        return files_of_run(Line(), config, Path(name), *stops)


@cache
def whole(kind: str) -> dict[str, bytes]:
    return run(CONFIGS[kind])


@settings(max_examples=8)
@given(st.sampled_from(list(CONFIGS)), st.sets(st.integers(1, 8), min_size=1, max_size=2))
def test_a_run_stopped_at_any_step_ends_in_the_same_bytes(kind: str, stops: set[int]) -> None:
    assert run(CONFIGS[kind], *stops) == whole(kind)


def test_averaged_weights_are_what_is_measured_and_kept(tmp_path: Path) -> None:
    averaged = CONFIGS["averaged, in parts, slower from epoch to epoch"]
    trained = train(Line(), averaged, RunFolder(tmp_path))
    state = read_weights(tmp_path / "checkpoint.safetensors")
    best = read_weights(tmp_path / "best.safetensors").part("network")
    assert trained.best.step == best_step(tmp_path) == 9
    assert best["0.weight"].equal(state.tensors["average.module.0.weight"])
    assert not best["0.weight"].equal(state.tensors["network.0.weight"])
    assert trained.network.get_parameter("0.weight").equal(best["0.weight"])
    assert trained.best.measured == Line().validation_of(trained.network)


def best_step(folder: Path) -> int:
    return int(read_weights(folder / "best.safetensors").facts["step"])


def test_a_scale_that_is_too_large_is_lowered_and_kept(tmp_path: Path) -> None:
    train(Line(factor=30), CONFIGS["float16"], RunFolder(tmp_path))
    scaler = read_weights(tmp_path / "checkpoint.safetensors").facts["learner"]["scaler"]
    assert 0 < scaler["scale"] < 2**16
