"""A network's file says how, from what and by which packages it was trained."""

from __future__ import annotations

import json

import torch
from torch import nn

from training.config import TrainingConfig
from training.run.checkpoint import Best
from training.run.facts import package_versions, run_facts
from training.run.loop import Trained


def test_a_run_tells_its_config_its_best_step_its_data_and_versions() -> None:
    config = TrainingConfig(steps=7, batch_size=2, learning_rate=0.1)
    best = Best(step=5, measured={"loss": 0.25})
    trained = Trained(network=nn.Linear(1, 1), best=best, steps=7, last_loss=0.5)
    facts = run_facts(config, trained, "beat", "c" * 64, ("transformers",))
    assert TrainingConfig.from_facts(facts["config"]) == config
    assert (facts["best_step"], facts["held_out"]) == (5, {"loss": 0.25})
    assert facts["data"] == {"kind": "beat", "sha256": "c" * 64}
    assert facts["versions"]["torch"] == torch.__version__
    assert facts["versions"].keys() - package_versions() == {"transformers"}
    assert json.loads(json.dumps(facts)) == facts
