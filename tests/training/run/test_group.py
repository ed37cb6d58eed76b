"""Several processes on one machine, which exchange gradients through gloo."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
import torch

from tests.training.lines import CONFIG, Line
from training.run.loop import train
from training.run.records import RunFolder
from training.weights_file import WeightsFile, read_weights

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def from_here(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


Asked = tuple[Path, dict[str, object], int]
"""The run folder, the changed settings, and the step after which to stop (0: none)."""


def learn_in_two(*trainings: Asked) -> int:
    """Train one after the other in the same two processes; to start them takes longer."""
    launcher = ["-m", "torch.distributed.run", "--standalone", "--nproc-per-node", "2"]
    program = [sys.executable, *launcher, "--no-python"]
    program += [sys.executable, "-W", "error", "-m", "tests.training.lines"]
    for folder, changed, stop in trainings:
        program += [str(folder), json.dumps(changed), str(stop)]
    return subprocess.run(program, check=False).returncode


def state_of(folder: Path) -> WeightsFile:
    return read_weights(folder / "checkpoint.safetensors")


def test_two_processes_equal_one_and_resume_after_ctrl_c(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    whole, halted = tmp_path / "whole", tmp_path / "halted"
    normed: dict[str, object] = {"steps": 4, "accumulate": 2, "normed": True}
    with_statistics: list[Asked] = [(whole, normed, 0), (halted, normed, 2), (halted, normed, 0)]
    refused: Asked = (tmp_path / "refused", {"batch_size": 1}, 0)
    two = tmp_path / "two"
    assert learn_in_two(*with_statistics, (two, {}, 3), (two, {}, 0), refused) == 1
    # When it resumed, every process began with the leading one's batch statistics.
    assert (halted / "stopped at 2").exists()
    for name, tensor in state_of(whole).tensors.items():
        assert tensor.equal(state_of(halted).tensors[name]), name
    assert (two / "stopped at 3").exists()
    assert "2 processes share steps of 1 examples" in capfd.readouterr().err
    train(Line(), CONFIG, RunFolder(tmp_path / "one"))
    together, one = state_of(two), state_of(tmp_path / "one")
    assert together.facts["step"] == 8
    assert together.tensors["network.idle.weight"].equal(one.tensors["network.idle.weight"])
    torch.testing.assert_close(dict(together.tensors), dict(one.tensors), rtol=1e-5, atol=1e-6)
    assert together.facts["best"]["measured"] == pytest.approx(one.facts["best"]["measured"])
    lines = [(tmp_path / way / "log.jsonl").read_text().splitlines() for way in ("two", "one")]
    assert len(lines[0]) == len(lines[1])
