from __future__ import annotations

from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from analysis.evaluators.examples import FeatureTask, split
from analysis.evaluators.networks import AutoencoderConfig, AutoencoderNetwork
from training.config import TrainingConfig
from training.run.group import Group
from training.run.learner import Learner
from training.run.loop import train
from training.run.records import RunFolder

CONFIG = AutoencoderConfig(window=12, stride=4, features=8)


@pytest.fixture
def task() -> FeatureTask:
    """Return windows of swings that one angle and one width tell."""
    chance = np.random.default_rng(0)
    times = np.arange(60)[:, None]
    clips = [
        (chance.uniform(0.5, 2) * np.sin(0.5 * times + chance.uniform(0, 6) + np.arange(4))).astype(
            np.float32
        )
        for _ in range(20)
    ]
    parts = split(
        clips,
        [f"r{number}" for number in range(20)],
        [""] * 20,
        names=[""],
        window=12,
        stride=4,
        floor=np.full(4, 0.01, np.float32),
        seed=0,
        device="cpu",
    )
    return FeatureTask(
        fresh=partial(AutoencoderNetwork, CONFIG),
        training=parts.training,
        held_out=parts.held_out,
        settings={},
        data_sha256="0" * 64,
    )


def test_windows_that_were_never_seen_are_rebuilt_better_than_by_the_mean(
    task: FeatureTask, tmp_path: Path
) -> None:
    config = TrainingConfig(steps=80, batch_size=32, learning_rate=0.01, validate_every=50)
    trained = train(task, config, RunFolder(tmp_path))
    assert trained.best.measured["error"] < 0.5 * trained.best.measured["error_of_mean"]


def test_the_loss_is_the_error_of_values_and_of_their_changes(task: FeatureTask) -> None:
    network = task.network().eval()
    rows = np.array([0, 5])
    windows, _ = task.training.batch(rows)
    with torch.no_grad():
        off = network(windows) - windows
        losses = task.losses(network, rows)
    torch.testing.assert_close(losses["error"], off.abs().mean())
    torch.testing.assert_close(losses["change"], (off[:, 1:] - off[:, :-1]).abs().mean())
    torch.testing.assert_close(losses["loss"], losses["error"] + losses["change"])


def test_a_step_in_parts_comes_to_the_autoencoder_of_one_part(task: FeatureTask) -> None:
    held_out = []
    for accumulate in (1, 4):
        torch.manual_seed(0)
        training = TrainingConfig(
            steps=3, batch_size=32, learning_rate=1e-3, optimizer="adam", accumulate=accumulate
        )
        learner = Learner(task, training, Group("cpu"))
        losses = [learner.learn(step)["loss"] for step in range(3)]
        with torch.no_grad():
            held_out.append((*losses, task.validation(learner.network.eval())["loss"]))
    assert held_out[1] == pytest.approx(held_out[0], rel=1e-4)
