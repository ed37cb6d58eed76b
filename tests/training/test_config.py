from __future__ import annotations

import json

import pytest

from motion.errors import InputError
from training.config import Decay, TrainingConfig

GOOD = {"steps": 10, "batch_size": 4, "learning_rate": 1e-3}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("steps", 0),
        ("batch_size", 0),
        ("learning_rate", 0.0),
        ("learning_rate", float("nan")),
        ("learning_rate", 2.0),
        ("optimizer", "sgd"),
        ("betas", (0.9, 1.0)),
        ("weight_decay", -1.0),
        ("gradient_clip", 0.0),
        ("accumulate", 0),
        ("ema_decay", 1.0),
        ("ema_decay", 0.0),
        ("precision", "float8"),
        ("validate_every", 0),
        ("checkpoint_every", 0),
        ("seed", -1),
    ],
)
def test_a_number_out_of_range_is_named(name: str, value: object) -> None:
    with pytest.raises(InputError, match=name):
        TrainingConfig(**{**GOOD, name: value})


@pytest.mark.parametrize("settings", [{"factor": 0.0}, {"factor": 1.1}, {"from_epoch": -1}])
def test_a_decay_out_of_range_is_named(settings: dict[str, float]) -> None:
    with pytest.raises(InputError, match=f"decay {next(iter(settings))}"):
        Decay(**{"factor": 0.9, **settings})


@pytest.mark.parametrize("decay", [None, Decay(factor=0.85, from_epoch=5)])
def test_a_config_survives_json(decay: Decay | None) -> None:
    config = TrainingConfig(
        **GOOD,
        betas=(0.95, 0.999),
        gradient_clip=None,
        optimizer="adam",
        decay=decay,
        ema_decay=0.999,
        precision="bfloat16",
    )
    assert TrainingConfig.from_facts(json.loads(json.dumps(config.facts()))) == config
