from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from tests.training.lines import ENTRIES
from tests.training.plain_lines import PlainLine, PlainNetwork
from training.config import Decay, TrainingConfig
from training.run.batches import batches_per_epoch, step_parts, step_rows
from training.run.group import Group
from training.run.learner import Learner

CONFIG = TrainingConfig(steps=8, batch_size=10, learning_rate=0.02, gradient_clip=0.5)


def learned(
    config: TrainingConfig, *, steps: int, chance: bool, normed: bool = False
) -> Learner[PlainNetwork]:
    torch.manual_seed(0)
    learner = Learner(PlainLine(chance=chance, normed=normed), config, Group("cpu"))
    for step in range(steps):
        learner.learn(step)
    return learner


@pytest.mark.parametrize(
    ("accumulate", "normed", "steps"), [(3, False, 6), (10, False, 6), (50, False, 6), (5, True, 2)]
)
def test_a_step_in_parts_equals_a_step_in_one(accumulate: int, normed: bool, steps: int) -> None:
    one, parts = (
        learned(config, steps=steps, chance=False, normed=normed)
        for config in (CONFIG, replace(CONFIG, accumulate=accumulate))
    )
    torch.testing.assert_close(parts.tensors(), one.tensors(), rtol=1e-4, atol=1e-5)
    assert parts.learn(steps) == pytest.approx(one.learn(steps), rel=1e-4)
    one, parts = (learned(c, steps=1, chance=True) for c in (CONFIG, replace(CONFIG, accumulate=2)))
    weights = [each.network.get_parameter("common.0.weight") for each in (one, parts)]
    assert not weights[0].equal(weights[1]), "each part draws chance of its own"


def test_the_mean_of_the_weights_follows_fast_at_first() -> None:
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


def test_a_mean_of_weights_has_batch_statistics_of_its_own() -> None:
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
def test_an_epoch_goes_through_all_examples_but_an_unfilled_batch(
    examples: int, size: int, seed: int
) -> None:
    count = batches_per_epoch(examples, size)
    rows = np.concatenate([step_rows(step, examples, size, seed) for step in range(count)])
    assert len(set(rows)) == len(rows) == min(examples, count * size)
    assert 0 <= rows.min() <= rows.max() < examples
    if examples > 9:
        following = step_rows(count, examples, size, seed)
        assert list(following) != list(rows[: len(following)]) or len(following) < 3


@given(st.integers(1, 60), st.integers(1, 9), st.integers(1, 4))
def test_parts_hold_each_example_once_and_are_shared_evenly(
    examples: int, accumulate: int, processes: int
) -> None:
    rows = np.arange(max(examples, processes))
    parts = step_parts(rows, accumulate, processes)
    assert np.array_equal(np.concatenate(parts), rows)
    assert len(parts) % processes == 0
    assert {len(part) for part in parts} <= {len(rows) // len(parts), -(-len(rows) // len(parts))}
    assert min(len(part) for part in parts) > 0
    if len(rows) >= accumulate + processes:
        assert accumulate <= len(parts) < accumulate + processes
