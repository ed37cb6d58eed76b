from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch
from torch import nn

from training.config import TrainingConfig
from training.run.checkpoint import Best
from training.run.loop import Trained
from training.run.records import RunLog, package_versions, run_facts


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


def test_a_log_grows_and_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "log.jsonl"
    log = grown(path, 6)
    assert RunLog(path, steps=6).lines == log.lines
    assert [json.loads(line) for line in path.read_text().splitlines()] == log.lines
    assert (log.steps, log.measured, log.last_loss) == (6, True, 1 / 6)
    assert not RunLog(path, steps=5).measured


@pytest.mark.parametrize("tail", ["", '{"step": 7, "lo', "\x00\x00", '{"step": 7, "loss": 1}'])
def test_steps_that_a_crash_lost_are_cut_off_when_the_run_goes_on(
    tail: str, tmp_path: Path
) -> None:
    whole, path = tmp_path / "whole.jsonl", tmp_path / "log.jsonl"
    grown(whole, 6)
    grown(path, 6)
    with path.open("a") as file:
        file.write(tail)
    before = path.read_bytes()
    log = RunLog(path, steps=4)
    assert path.read_bytes() == before
    for line in RunLog(whole, steps=6).lines[len(log.lines) :]:
        log.add(line)
    log.save()
    assert path.read_bytes() == whole.read_bytes()


def test_a_run_tells_its_config_its_best_step_its_data_and_versions() -> None:
    config = TrainingConfig(steps=7, batch_size=2, learning_rate=0.1)
    best = Best(step=5, measured={"loss": 0.25})
    trained = Trained(network=nn.Linear(1, 1), best=best, steps=7, last_loss=0.5)
    facts = run_facts(config, trained, "beat", "c" * 64, ("transformers",))
    assert facts["config"] == config.facts()
    assert (facts["best_step"], facts["held_out"]) == (5, {"loss": 0.25})
    assert facts["data"] == {"kind": "beat", "sha256": "c" * 64}
    assert facts["versions"]["torch"] == torch.__version__
    assert facts["versions"].keys() - package_versions() == {"transformers"}
    assert json.loads(json.dumps(facts)) == facts
