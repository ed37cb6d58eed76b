"""Speech2UnifiedExpressions learns, reports its data, and resumes where it was stopped."""

from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch

from generators.s2ue.config import ABLATIONS, PRESETS, LossWeights
from generators.s2ue.model import load_network
from generators.s2ue.train import S2ueTask, train_s2ue
from motion.errors import InputError
from tests.generators.s2ue.small_network import FACE, SMALL, standing
from tests.generators.small_training import Learn, test_training_stays_on_its_device, training_on
from tests.training.takes import takes_of_curves
from training.data.feature_cache import PreparedTakes
from training.data.windows import Windows
from training.speakers import Speakers

__all__ = ["test_training_stays_on_its_device"]


@pytest.fixture(scope="module", name="takes")
def _takes() -> PreparedTakes:
    """Takes of two speakers whose motion is one curve, which is in the sound."""
    chance = np.random.default_rng(3)
    mixing = np.concatenate(
        [0.1 * chance.normal(size=27), 1e-3 * chance.normal(size=3 * FACE.count)]
    )

    def features_of(curve: np.ndarray) -> dict[str, np.ndarray]:
        widths = {"sound": 84, "spectrum": 128, "words": 300}
        heard = {name: np.repeat(curve, width, axis=1) for name, width in widths.items()}
        return {"motion": standing() + curve * mixing, **heard}

    return takes_of_curves(features_of, speakers="abababab", frame_rate=15.0)


@pytest.fixture(name="learn")
def _learn(takes: PreparedTakes, monkeypatch: pytest.MonkeyPatch) -> Learn:
    sizes = {name: getattr(SMALL, name) for name in ("hidden", "node_width", "part_width", "reach")}
    tiny = replace(PRESETS["tiny"], sizes=sizes)
    monkeypatch.setattr("generators.s2ue.train.PRESETS", {"tiny": tiny})
    return training_on(takes, train_s2ue, monkeypatch, batch_size=8, checkpoint_every=100)


def task(takes: PreparedTakes) -> S2ueTask:
    return S2ueTask(
        config=SMALL,
        weights=LossWeights(),
        face=FACE,
        training=Windows(takes, split="train", frames=34, stride=10),
        held_out=Windows(takes, split="validation", frames=34, stride=34),
        speakers=Speakers(("a", "b"), 2),
    )


def test_training_improves_the_network_and_reports_its_data(learn: Learn, tmp_path: Path) -> None:
    outcome = learn(16, tmp_path / "a.safetensors")
    assert "24 windows of 6 takes by 2 speakers (a, b)" in outcome.sentences[0]
    assert any("stand-in for FastText" in one for one in outcome.warnings)
    assert any("no recording has a transcript" in one for one in outcome.warnings)
    loaded = load_network(tmp_path / "a.safetensors", FACE)
    assert loaded.speakers.names == ("a", "b")
    learn(1, tmp_path / "brief.safetensors")
    brief = load_network(tmp_path / "brief.safetensors", FACE)
    few, many = (one.training["held_out"]["reconstruction"] for one in (brief, loaded))
    assert many < 0.9 * few


@pytest.mark.parametrize("ablation", list(ABLATIONS))
def test_ablations_are_trained_and_recorded(learn: Learn, tmp_path: Path, ablation: str) -> None:
    learn(2, tmp_path / "a.safetensors", ablation=ablation)
    loaded = load_network(tmp_path / "a.safetensors", FACE)
    assert loaded.training["ablation"] == ablation
    chosen = asdict(loaded.model.config) | loaded.training["losses"]
    assert {name: chosen[name] for name in ABLATIONS[ablation]} == ABLATIONS[ablation]
    passes = {one["name"] for one in loaded.training["config"]["passes"]}
    assert ("discriminator" in passes) == (ablation != "without_discriminator")
    assert ("phonemes" in passes) == (ablation != "without_face")


def test_each_pass_trains_its_own_network(takes: PreparedTakes) -> None:
    expected = task(takes)
    network = expected.network().train()
    rows = np.arange(6)
    for name in ("generator", "discriminator", "phonemes"):
        network.zero_grad()
        torch.autograd.backward(expected.losses(network, rows, name)["loss"])
        part = network.get_submodule(name)
        assert all(one.grad is not None for one in part.parameters()), name
        if name != "generator":
            assert all(one.grad is None for one in network.generator.parameters())


def test_the_network_stores_the_spread_of_the_recordings(takes: PreparedTakes) -> None:
    network, windows = task(takes).network(), task(takes).training
    motion = windows.batch(np.arange(len(windows)))["motion"].reshape(-1, 27 + 3 * FACE.count)
    np.testing.assert_allclose(network.mean.numpy(), motion.mean(axis=0), atol=1e-5)
    deviation = np.maximum(motion.std(axis=0), 1e-5)
    np.testing.assert_allclose(network.deviation.numpy(), deviation, rtol=1e-3)
    np.testing.assert_array_equal(network.rest.numpy(), takes.mean_first("motion"))


def test_recordings_without_faces_need_the_ablation(learn: Learn, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="have no face"):
        learn(1, tmp_path / "a.safetensors", kind="ted")
    assert not list(tmp_path.iterdir())
    learn(1, tmp_path / "a.safetensors", kind="ted", ablation="without_face")
