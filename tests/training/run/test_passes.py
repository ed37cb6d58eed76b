"""Several updates in a step, and training in stages."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from motion.errors import InputError
from tests.training.lines import ENTRIES, VALUES, LineTask, files_of_run
from training.config import TrainingConfig
from training.run.batches import step_rows
from training.run.group import Group
from training.run.learner import Learner
from training.run.loop import train
from training.run.passes import Pass
from training.run.records import RunFolder
from training.weights_file import read_weights

JUDGE = Pass(name="judge", parts=("judge",), learning_rate=0.005)
MAKER = Pass(name="maker", parts=("maker", "last"))
CONFIG = TrainingConfig(
    steps=9,
    batch_size=8,
    learning_rate=0.02,
    optimizer="adam",
    gradient_clip=None,
    validate_every=4,
    passes=(JUDGE, MAKER),
)


class Rivals(nn.Module):
    """One makes lines, the other distinguishes them from true ones."""

    def __init__(self, *, chance: bool) -> None:
        super().__init__()
        layers = (nn.BatchNorm1d(8), nn.Dropout(0.3)) if chance else ()
        self.maker = nn.Sequential(nn.Linear(3, 8), *layers, nn.Tanh())
        self.last = nn.Linear(8, 1)
        self.judge = nn.Sequential(nn.Linear(4, 8), nn.Tanh(), nn.Linear(8, 1))

    def forward(self, entries: Tensor) -> Tensor:
        result: Tensor = self.last(self.maker(entries))
        return result


@dataclass(frozen=True, kw_only=True)
class Rivalry(LineTask[Rivals]):
    chance: bool = True

    def network(self) -> Rivals:
        return Rivals(chance=self.chance)

    def losses_of(
        self, name: str, network: Rivals, rows: NDArray[np.int64]
    ) -> Mapping[str, Tensor]:
        entries, values = ENTRIES[torch.from_numpy(rows)], VALUES[torch.from_numpy(rows)]
        if self.chance:
            entries = entries + 0.1 * torch.randn(len(rows), 3)
        made = network(entries)
        made_up = network.judge(torch.cat([entries, made], dim=1))
        if name == "judge":
            frozen = not any(weight.requires_grad for weight in network.maker.parameters())
            assert frozen or not torch.is_grad_enabled()
            real = network.judge(torch.cat([entries, values], dim=1))
            return {"loss": (real - 1).square().mean() + made_up.square().mean()}
        fit = nn.functional.mse_loss(made, values)
        return {"loss": fit + (made_up - 1).square().mean(), "fit": fit}

    def validation(self, network: Rivals) -> Mapping[str, float]:
        return {"loss": float(nn.functional.mse_loss(network(ENTRIES[32:]), VALUES[32:]))}


def learner_of(config: TrainingConfig, *, chance: bool = False) -> Learner[Rivals]:
    torch.manual_seed(0)
    return Learner(Rivalry(chance=chance), config, Group("cpu"))


def state(learner: Learner[Rivals]) -> dict[str, Tensor]:
    return {
        name.removeprefix("network."): tensor.clone()
        for name, tensor in learner.tensors().items()
        if name.startswith("network.")
    }


def moved(before: dict[str, Tensor], after: dict[str, Tensor]) -> set[str]:
    return {name.split(".")[0] for name in before if not before[name].equal(after[name])}


def test_two_passes_equal_two_optimizers() -> None:
    learner = learner_of(CONFIG)
    torch.manual_seed(0)
    task = Rivalry(chance=False)
    plain = task.network()
    judges = torch.optim.Adam(plain.judge.parameters(), lr=0.005)
    makers = torch.optim.Adam([*plain.maker.parameters(), *plain.last.parameters()], lr=0.02)
    for step in range(6):
        told = learner.learn(step)
        rows = step_rows(step, 32, 8, 0)
        for name, optimizer, others in (
            ("judge", judges, (plain.maker, plain.last)),
            ("maker", makers, (plain.judge,)),
        ):
            plain.requires_grad_(True)
            for other in others:
                other.requires_grad_(False)
            optimizer.zero_grad()
            losses = task.losses_of(name, plain, rows)
            torch.autograd.backward(losses["loss"])
            optimizer.step()
            assert told[name] == pytest.approx(float(losses["loss"].detach()), rel=1e-5)
        assert told["loss"] == told["judge"]
        assert set(told) == {"loss", "judge", "maker", "fit"}
    for name, weight in plain.state_dict().items():
        torch.testing.assert_close(state(learner)[name], weight, rtol=1e-5, atol=1e-6)


def test_a_pass_has_its_rhythm_and_its_rate() -> None:
    learner = learner_of(replace(CONFIG, passes=(MAKER, replace(JUDGE, every=3, first=1))))
    changed = []
    for step in range(6):
        before = state(learner)
        told = learner.learn(step)
        changed.append("judge" in moved(before, state(learner)))
        assert ("judge" in told, "loss" in told) == (step in (1, 4), True)
    assert changed == [False, True, False, False, True, False]
    assert learner.learning_rates(0) == {"learning_rate_maker": 0.02}
    assert learner.learning_rates(4) == {"learning_rate_maker": 0.02, "learning_rate_judge": 0.005}


def test_untaught_parts_are_frozen_with_their_statistics_and_without_dropout() -> None:
    stages = (replace(MAKER, parts=("maker", "last"), end=3), replace(JUDGE, first=3))
    learner = learner_of(replace(CONFIG, passes=stages, ema_decay=0.5), chance=True)
    seen = []
    for step in range(6):
        before = state(learner)
        mean = learner.network.get_buffer("maker.1.running_mean").clone()
        learner.learn(step)
        seen.append(moved(before, state(learner)))
        assert learner.network.get_buffer("maker.1.running_mean").equal(mean) == (step >= 3)
        assert learner._network.maker[2].training == (step < 3)
    assert seen == [{"maker", "last"}] * 3 + [{"judge"}] * 3
    assert all(weight.requires_grad for weight in learner._network.parameters())


STAGED = replace(
    CONFIG,
    accumulate=2,
    ema_decay=0.8,
    weight_decay=0.1,
    optimizer="adamw",
    gradient_clip=0.5,
    passes=(replace(MAKER, end=5), replace(JUDGE, every=2), replace(MAKER, name="late", first=5)),
)


def test_a_run_in_passes_and_stages_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    parts = files_of_run(Rivalry(), STAGED, tmp_path / "parts", 1, 5, 8)
    assert parts == files_of_run(Rivalry(), STAGED, tmp_path / "whole")


def test_weights_are_chosen_among_those_of_the_last_stage(tmp_path: Path) -> None:
    beginning: list[Tensor] = []

    class Forgetful(Rivalry):
        """Measures how far the judge is from its beginning: least before it learns."""

        def validation(self, network: Rivals) -> Mapping[str, float]:
            weight = network.judge.get_parameter("0.weight")
            beginning.append(weight.clone())
            return {"moved": float((weight - beginning[0]).abs().sum())}

    stages = (replace(MAKER, end=5), replace(JUDGE, learning_rate=0.1, first=5))
    config = replace(CONFIG, passes=stages, validate_every=1)
    trained = train(Forgetful(), config, RunFolder(tmp_path))
    lines = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    measured = {line["step"]: line["held_out"]["moved"] for line in lines if "held_out" in line}
    assert measured[5] < min(value for step, value in measured.items() if step > 5)
    assert trained.best.step > 5
    assert read_weights(tmp_path / "best.safetensors").facts["step"] == trained.best.step


@pytest.mark.parametrize(
    ("passes", "message"),
    [
        ((replace(MAKER, parts=("painter",)),), r"trains 'painter'.*parts: maker, last, judge"),
        ((replace(MAKER, every=2),), "no pass is made in step 2 of 9"),
        ((replace(MAKER, end=4), replace(JUDGE, first=5)), "no pass is made in step 5 of 9"),
    ],
)
def test_passes_that_do_not_fit_the_network_or_the_steps_are_refused(
    passes: tuple[Pass, ...], message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        train(Rivalry(), replace(CONFIG, passes=passes), RunFolder(tmp_path))
