"""A training's loop: stopped anywhere it resumes to the same bytes, and so does its log."""

import json
import signal
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from motion.errors import InputError
from tests.training.lines import Line, LineNetwork, files_of_run, interrupt_after
from training.config import Decay, TrainingConfig
from training.run.loop import TrainingStopped, train
from training.run.records import LogLine, RunFolder, RunLog, draw_curves
from training.weights_file import read_weights

CONFIG = TrainingConfig(
    steps=23, batch_size=8, learning_rate=0.05, weight_decay=0.01, validate_every=5
)
FILES = ("checkpoint.safetensors", "best.safetensors", "log.jsonl", "curves.png")


def refuse_a_step(done: int, total: int, detail: str) -> None:
    pytest.fail(f"step {done} of {total} was made")


def content(folder: Path) -> dict[str, bytes]:
    return {name: (folder / name).read_bytes() for name in FILES}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Return the files of an uninterrupted run."""
    folder = tmp_path_factory.mktemp("whole")
    train(Line(), CONFIG, RunFolder(folder))
    return content(folder)


@pytest.fixture
def finished(whole: dict[str, bytes], tmp_path: Path) -> Path:
    """Return the folder of such a run."""
    for name, bytes_of_file in whole.items():
        (tmp_path / name).write_bytes(bytes_of_file)
    return tmp_path


def test_a_run_killed_between_two_saves_or_in_one_resumes_from_the_last_one(
    whole: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = replace(CONFIG, checkpoint_every=6)
    saved: dict[str, bytes] = {}

    def show(done: int, total: int, detail: str) -> None:
        if done == 12:
            saved["checkpoint"] = (tmp_path / FILES[0]).read_bytes()
        if done == 17:
            raise RuntimeError("killed")

    with pytest.raises(RuntimeError, match="killed"):
        train(Line(), config, RunFolder(tmp_path), show=show)
    assert (tmp_path / FILES[0]).read_bytes() == saved["checkpoint"]
    with monkeypatch.context() as patch:
        patch.setattr("training.run.loop.draw_curves", lambda *_, **__: show(17, 23, ""))
        with pytest.raises(RuntimeError, match="killed"):
            train(Line(), replace(config, checkpoint_every=500), RunFolder(tmp_path))
    train(Line(), replace(config, checkpoint_every=500), RunFolder(tmp_path))
    assert content(tmp_path) == whole


def test_a_finished_run_is_not_trained_again(finished: Path, whole: dict[str, bytes]) -> None:
    trained = train(Line(), CONFIG, RunFolder(finished), show=refuse_a_step)
    assert content(finished) == whole
    best = read_weights(finished / "best.safetensors")
    assert (trained.steps, trained.best.step) == (23, best.facts["step"])
    for name, tensor in trained.network.state_dict().items():
        assert torch.equal(tensor, best.tensors[f"network.{name}"])


def test_the_number_of_steps_may_be_raised_but_not_lowered(finished: Path) -> None:
    with pytest.raises(InputError, match="made 23 steps, more than 10"):
        train(Line(), replace(CONFIG, steps=10), RunFolder(finished))
    assert train(Line(), replace(CONFIG, steps=30), RunFolder(finished)).steps == 30


@pytest.mark.parametrize(
    ("task", "config", "message"),
    [
        (Line(), replace(CONFIG, learning_rate=0.1), "learning_rate was 0.05 and is 0.1"),
        (Line(), replace(CONFIG, seed=1), "training seed was 0 and is 1"),
        (Line(settings={"kind": "arc"}), CONFIG, "task kind was 'line' and is 'arc'"),
        (Line(data_sha256="b" * 64), CONFIG, "data sha256 was 'aaaa"),
    ],
)
def test_other_settings_or_data_cannot_resume_a_run_and_are_named(
    task: Line, config: TrainingConfig, message: str, finished: Path, whole: dict[str, bytes]
) -> None:
    with pytest.raises(InputError, match=message) as refused:
        train(task, config, RunFolder(finished))
    assert refused.value.where == str(finished)
    assert content(finished) == whole


def measure(task: Line, network: LineNetwork) -> Mapping[str, float]:
    with torch.no_grad():
        return task.validation(network.eval())


class Small(Line):
    """A line whose best weights are the smallest, independent of its loss."""

    def validation(self, network: LineNetwork) -> Mapping[str, float]:
        size = float(network.get_parameter("common.0.weight").abs().sum())
        return {"size": size, **super().validation(network)}


def test_the_returned_weights_are_the_best_by_the_tasks_first_measure(tmp_path: Path) -> None:
    with pytest.raises(TrainingStopped):
        train(Small(), CONFIG, RunFolder(tmp_path), show=interrupt_after(17))
    trained = train(Small(), CONFIG, RunFolder(tmp_path))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    assert [line["step"] for line in lines if "loss" in line] == list(range(1, 24))
    measured = {line["step"]: line["held_out"] for line in lines if "held_out" in line}
    assert list(measured) == [5, 10, 15, 20, 23]
    assert trained.best.step == min(measured, key=lambda step: measured[step]["size"])
    assert trained.best.step != min(measured, key=lambda step: measured[step]["loss"])
    assert measure(Small(), trained.network) == trained.best.measured


def test_training_keeps_the_callers_random_state_and_settings(tmp_path: Path) -> None:
    torch.manual_seed(3)
    expected = torch.rand(4)
    torch.manual_seed(3)
    before = signal.getsignal(signal.SIGINT)
    train(Line(), replace(CONFIG, steps=2), RunFolder(tmp_path))
    assert torch.equal(torch.rand(4), expected)
    assert not torch.are_deterministic_algorithms_enabled()
    assert signal.getsignal(signal.SIGINT) is before


def test_a_nan_loss_and_a_missing_gpu_are_reported(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"loss is no longer a number.*step 1.*smaller learning rate"
    ):
        train(Line(factor=float("inf")), CONFIG, RunFolder(tmp_path))
    assert not (tmp_path / "checkpoint.safetensors").exists()
    if not torch.cuda.is_available():
        with pytest.raises(InputError, match="finds no GPU"):
            train(Line(device="cuda"), CONFIG, RunFolder(tmp_path))


def test_a_damaged_state_or_log_is_reported(finished: Path, whole: dict[str, bytes]) -> None:
    (finished / "log.jsonl").write_bytes(whole["log.jsonl"].split(b"\n", 1)[0])
    with pytest.raises(InputError, match=r"log\.jsonl: the log holds \d of the 23 steps"):
        train(Line(), CONFIG, RunFolder(finished))
    (finished / "checkpoint.safetensors").write_bytes(b"cut off")
    with pytest.raises(InputError, match=r"checkpoint\.safetensors: .* damaged"):
        train(Line(), CONFIG, RunFolder(finished))


def test_an_unwritable_output_is_refused_before_training(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder")
    with pytest.raises(OSError, match="file"):
        train(Line(), CONFIG, RunFolder(tmp_path / "file" / "run"), show=refuse_a_step)


PLAIN = TrainingConfig(steps=9, batch_size=8, learning_rate=0.05, validate_every=4)
CONFIGS = {
    "averaged, in parts, slower from epoch to epoch": replace(
        PLAIN, ema_decay=0.9, accumulate=3, decay=Decay(factor=0.7)
    ),
    "bfloat16": replace(PLAIN, precision="bfloat16", ema_decay=0.5),
}


def run(config: TrainingConfig, *stops: int) -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as name:
        return files_of_run(Line(normed=True), config, Path(name), *stops)


@cache
def of_whole(kind: str) -> dict[str, bytes]:
    return run(CONFIGS[kind])


@settings(max_examples=8)
@given(st.sampled_from(list(CONFIGS)), st.sets(st.integers(1, 8), min_size=1, max_size=2))
def test_a_run_stopped_at_any_step_ends_in_the_same_bytes(kind: str, stops: set[int]) -> None:
    assert run(CONFIGS[kind], *stops) == of_whole(kind)


def test_averaged_weights_are_evaluated_and_saved(tmp_path: Path) -> None:
    averaged = CONFIGS["averaged, in parts, slower from epoch to epoch"]
    trained = train(Line(), averaged, RunFolder(tmp_path))
    state = read_weights(tmp_path / "checkpoint.safetensors").tensors
    best = read_weights(tmp_path / "best.safetensors").tensors["network.common.0.weight"]
    assert best.equal(state["average.module.common.0.weight"])
    assert not best.equal(state["network.common.0.weight"])
    assert trained.network.get_parameter("common.0.weight").equal(best)
    assert trained.best.measured == measure(Line(), trained.network)


def test_resuming_cuts_steps_lost_by_a_crash_off_the_log(tmp_path: Path) -> None:
    lines: list[LogLine] = []
    for step in range(1, 7):
        lines.append({"step": step, "learning_rate": 0.1, "loss": 1 / step})
        if step % 3 == 0:
            lines.append({"step": step, "held_out": {"loss": 2 / step}})
    log = RunLog(tmp_path / "log.jsonl", steps=0)
    log.lines.extend(lines)
    log.save()
    assert RunLog(tmp_path / "log.jsonl", steps=6).lines == lines
    assert RunLog(tmp_path / "log.jsonl", steps=4).lines == lines[:5]


@pytest.mark.parametrize("steps", [1, 40, 3000])
def test_equal_logs_make_equal_plots_with_held_out_measures(steps: int, tmp_path: Path) -> None:
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
        assert picture.size == (1200, 300)
        pixels = np.asarray(picture.convert("RGB"))
    assert (pixels == (0xB3, 0x54, 0x1E)).all(axis=2).any() == bool(held_out)
