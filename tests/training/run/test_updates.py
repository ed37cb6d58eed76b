"""Updates of a step, in parts and in passes."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor, nn

from motion.arrays import Ints
from tests.training.lines import ENTRIES, VALUES, Line, LineNetwork, files_of_run
from training.config import Decay, Pass, TrainingConfig
from training.run.batches import batches_per_epoch, step_rows
from training.run.group import Group
from training.run.learner import Learner
from training.run.loop import train
from training.run.records import RunFolder
from training.weights_file import read_weights

CONFIG = TrainingConfig(steps=8, batch_size=10, learning_rate=0.02, gradient_clip=0.5)


def learned(
    config: TrainingConfig, *, steps: int, chance: bool, normed: bool = False
) -> Learner[LineNetwork]:
    torch.manual_seed(0)
    learner = Learner(Line(chance=chance, normed=normed), config, Group("cpu"))
    for step in range(steps):
        learner.learn(step)
    return learner


@pytest.mark.parametrize("accumulate", [3, 10, 50])
def test_a_step_in_parts_equals_a_step_in_one(accumulate: int) -> None:
    steps = 6
    one, parts = (
        learned(config, steps=steps, chance=False)
        for config in (CONFIG, replace(CONFIG, accumulate=accumulate))
    )
    torch.testing.assert_close(parts.tensors(), one.tensors(), rtol=1e-4, atol=1e-5)
    assert parts.learn(steps) == pytest.approx(one.learn(steps), rel=1e-4)
    one, parts = (learned(c, steps=1, chance=True) for c in (CONFIG, replace(CONFIG, accumulate=2)))
    weights = [each.network.get_parameter("common.0.weight") for each in (one, parts)]
    assert not weights[0].equal(weights[1]), "each part draws chance of its own"


def test_the_running_mean_of_weights_adapts_fast_at_first() -> None:
    learner = learned(replace(CONFIG, ema_decay=0.9), steps=0, chance=True)
    expected = torch.zeros(8, 3)
    for step in range(30):
        learner.learn(step)
        weight = learner.tensors()["network.common.0.weight"].clone()
        kept = 0 if step == 0 else min(0.9, (1 + step) / (10 + step))
        expected = kept * expected + (1 - kept) * weight
    torch.testing.assert_close(learner.network.get_parameter("common.0.weight").detach(), expected)


def test_the_learning_rate_falls_from_epoch_to_epoch() -> None:
    # 32 examples make three steps of ten an epoch.
    config = replace(CONFIG, decay=Decay(factor=0.85, from_epoch=2))
    learner = learned(config, steps=0, chance=True)
    rates = [learner.learning_rates(step) for step in (0, 5, 6, 8, 9, 12)]
    assert [rate["learning_rate"] for rate in rates] == pytest.approx(
        [0.02, 0.02, 0.017, 0.017, 0.01445, 0.0122825]
    )
    constant = learned(CONFIG, steps=0, chance=True)
    assert constant.learning_rates(10**6) == {"learning_rate": 0.02}


def test_the_mean_of_weights_has_its_own_batch_statistics() -> None:
    config = replace(CONFIG, batch_size=32, gradient_clip=None, ema_decay=0.9)
    learner = learned(config, steps=0, chance=False, normed=True)
    mean, variance = torch.zeros(8), torch.ones(8)
    for step in range(5):
        learner.learn(step)
        with torch.no_grad():
            seen = learner.network.common[0](ENTRIES[:32])
        mean, variance = 0.9 * mean + 0.1 * seen.mean(dim=0), 0.9 * variance + 0.1 * seen.var(dim=0)
    layer = learner.network.common[1]
    assert isinstance(layer, torch.nn.BatchNorm1d)
    assert layer.running_var is not None
    torch.testing.assert_close(layer.running_mean, mean)
    torch.testing.assert_close(layer.running_var, variance)
    assert not layer.running_var.equal(learner.tensors()["network.common.1.running_var"])


@given(st.integers(1, 60), st.integers(1, 20), st.integers(0, 5))
def test_an_epoch_covers_all_examples_except_an_incomplete_batch(
    examples: int, size: int, seed: int
) -> None:
    count = batches_per_epoch(examples, size)
    rows = np.concatenate([step_rows(step, examples, size, seed) for step in range(count)])
    assert len(set(rows)) == len(rows) == min(examples, count * size)
    assert 0 <= rows.min() <= rows.max() < examples
    if examples > 9:
        following = step_rows(count, examples, size, seed)
        assert list(following) != list(rows[: len(following)]) or len(following) < 3


FOLLOWER = Pass(name="follower", parts=("idle",), learning_rate=0.005)
LEADER = Pass(name="leader", parts=("common", "rare"))
IN_PASSES = TrainingConfig(
    steps=9,
    batch_size=8,
    learning_rate=0.02,
    optimizer="adam",
    gradient_clip=None,
    validate_every=4,
    passes=(FOLLOWER, LEADER),
)


@dataclass(frozen=True, kw_only=True)
class Following(Line):
    """A layer learns the output of the others, which learn a line."""

    def losses(self, network: LineNetwork, rows: Ints, name: str = "") -> Mapping[str, Tensor]:
        entries, values = ENTRIES[torch.from_numpy(rows)], VALUES[torch.from_numpy(rows)]
        if self.chance:
            entries = entries + 0.1 * torch.randn(len(rows), 3)
        result = network(entries, torch.from_numpy(rows) >= 0)
        if name == "follower":
            frozen = not any(weight.requires_grad for weight in network.common.parameters())
            assert frozen or not torch.is_grad_enabled()
            return {"loss": nn.functional.mse_loss(network.idle(entries), result)}
        return {"loss": nn.functional.mse_loss(result, values), "size": result.abs().mean()}


def learner_of(config: TrainingConfig, *, normed: bool = False) -> Learner[LineNetwork]:
    torch.manual_seed(0)
    return Learner(Following(chance=normed, normed=normed), config, Group("cpu"))


def state(learner: Learner[LineNetwork]) -> dict[str, Tensor]:
    return {
        name.removeprefix("network."): tensor.clone()
        for name, tensor in learner.tensors().items()
        if name.startswith("network.")
    }


def moved(before: dict[str, Tensor], after: dict[str, Tensor]) -> set[str]:
    return {name.split(".")[0] for name in before if not before[name].equal(after[name])}


def test_two_passes_equal_two_optimizers() -> None:
    learner = learner_of(IN_PASSES)
    torch.manual_seed(0)
    task = Following(chance=False)
    plain = task.network()
    leading = [*plain.common.parameters(), *plain.rare.parameters()]
    follower = torch.optim.Adam(plain.idle.parameters(), lr=0.005)
    leader = torch.optim.Adam(leading, lr=0.02)
    for step in range(6):
        told = learner.learn(step)
        rows = step_rows(step, 32, 8, 0)
        for name, optimizer in (("follower", follower), ("leader", leader)):
            for weight in leading:
                weight.requires_grad_(name == "leader")
            optimizer.zero_grad()
            losses = task.losses(plain, rows, name)
            torch.autograd.backward(losses["loss"])
            optimizer.step()
            assert told[name] == pytest.approx(float(losses["loss"].detach()), rel=1e-5)
        assert told["loss"] == told["follower"]
        assert set(told) == {"loss", "follower", "leader", "size"}
    for name, weight in plain.state_dict().items():
        torch.testing.assert_close(state(learner)[name], weight, rtol=1e-5, atol=1e-6)


def test_untrained_parts_are_frozen_including_statistics_and_dropout() -> None:
    stages = (replace(LEADER, end=3), replace(FOLLOWER, first=3))
    learner = learner_of(replace(IN_PASSES, passes=stages, ema_decay=0.5), normed=True)
    seen = []
    for step in range(6):
        before = state(learner)
        mean = learner.network.get_buffer("common.1.running_mean").clone()
        learner.learn(step)
        seen.append(moved(before, state(learner)))
        assert learner.network.get_buffer("common.1.running_mean").equal(mean) == (step >= 3)
        assert learner._network.common[3].training == (step < 3)
    assert seen == [{"common", "rare"}] * 3 + [{"idle"}] * 3
    assert all(weight.requires_grad for weight in learner._network.parameters())


def test_a_resumed_run_with_passes_and_stages_ends_in_the_same_bytes(tmp_path: Path) -> None:
    config = replace(
        IN_PASSES,
        accumulate=2,
        ema_decay=0.8,
        weight_decay=0.1,
        optimizer="adamw",
        gradient_clip=0.5,
        passes=(replace(LEADER, end=5), FOLLOWER, replace(LEADER, name="late", first=5)),
    )
    parts = files_of_run(Following(normed=True), config, tmp_path / "parts", 1, 5, 8)
    assert parts == files_of_run(Following(normed=True), config, tmp_path / "whole")


def test_weights_are_selected_from_the_last_stage(tmp_path: Path) -> None:
    beginning: list[Tensor] = []

    class Forgetful(Following):
        """Measures how far the follower is from its beginning: least before it learns."""

        def validation(self, network: LineNetwork) -> Mapping[str, float]:
            beginning.append(network.idle.weight.clone())
            return {"moved": float((beginning[-1] - beginning[0]).abs().sum())}

    stages = (replace(LEADER, end=5), replace(FOLLOWER, learning_rate=0.1, first=5))
    config = replace(IN_PASSES, passes=stages, validate_every=1)
    trained = train(Forgetful(), config, RunFolder(tmp_path))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    measured = {line["step"]: line["held_out"]["moved"] for line in lines if "held_out" in line}
    assert measured[5] < min(value for step, value in measured.items() if step > 5)
    assert trained.best.step > 5
    assert read_weights(tmp_path / "best.safetensors").facts["step"] == trained.best.step
