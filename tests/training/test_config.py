from __future__ import annotations

from dataclasses import replace

import pytest

from motion.errors import InputError
from training.config import Decay, TrainingConfig

GOOD = TrainingConfig(steps=10, batch_size=4, learning_rate=1e-3)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        *((name, 0) for name in ("steps", "batch_size", "accumulate", "validate_every")),
        *(("learning_rate", value) for value in (0.0, float("nan"), 2.0)),
        *(("optimizer", "sgd"), ("betas", (0.9, 1.0)), ("weight_decay", -1.0)),
        *(("gradient_clip", 0.0), ("ema_decay", 1.0), ("precision", "float8"), ("seed", -1)),
    ],
)
def test_a_number_out_of_range_is_named(name: str, value: object) -> None:
    with pytest.raises(InputError, match=name):
        replace(GOOD, **{name: value})  # type: ignore[arg-type]  # wrong on purpose


@pytest.mark.parametrize(
    ("name", "factor", "from_epoch"),
    [("factor", 0.0, 1), ("factor", 1.1, 1), ("from_epoch", 0.9, -1)],
)
def test_a_decay_out_of_range_is_named(name: str, factor: float, from_epoch: int) -> None:
    with pytest.raises(InputError, match=f"decay {name}"):
        Decay(factor=factor, from_epoch=from_epoch)
