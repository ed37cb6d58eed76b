"""AMUSE's motion networks learn, report their data, and resume where they were stopped."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from unittest.mock import Mock

import numpy as np
import pytest
import torch

from generators.amuse.config import MOTION_PRESETS
from generators.amuse.losses import MOTION_LOSSES
from generators.amuse.network_file import load_motion, load_speech
from generators.amuse.train import MotionTask, speech_latents, train_amuse
from motion.audio import Audio, write_wav
from motion.errors import InputError
from tests.generators.amuse.small_networks import MOTION, written_networks
from tests.generators.small_training import Learn, test_training_stays_on_its_device, training_on
from tests.training.takes import take_named, takes_of_curves
from training.data.feature_cache import PreparedTakes
from training.data.windows import Windows

__all__ = ["test_training_stays_on_its_device"]

FRAMES = 12


@pytest.fixture(scope="module", name="takes")
def _takes() -> PreparedTakes:
    """Takes whose motion is one curve, which is in the speech latents."""
    mixing = np.random.default_rng(3).standard_normal((1, 333))

    def features_of(curve: np.ndarray) -> dict[str, np.ndarray]:
        means = curve.reshape(-1, FRAMES).mean(axis=1)
        return {"motion": curve @ mixing, "latents": np.tile(np.repeat(means, FRAMES), (24, 1)).T}

    return takes_of_curves(features_of, speakers=["1"] * 8, frame_rate=30.0, frames=5 * FRAMES)


@pytest.fixture(name="learn")
def _learn(takes: PreparedTakes, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Learn:
    settings = written_networks(tmp_path)
    tiny = replace(
        MOTION_PRESETS["tiny"],
        network=replace(MOTION, frames=FRAMES, tokens=2),
        stride=FRAMES,
        together=4,
        align_steps=5,
    )
    monkeypatch.setattr("generators.amuse.train.MOTION_PRESETS", {"tiny": tiny})
    learn = training_on(takes, train_amuse, monkeypatch, batch_size=16, learning_rate=3e-3)
    return partial(learn, speech_model=str(settings.speech_model))


def test_a_short_training_improves_reconstruction_and_denoising(
    learn: Learn, tmp_path: Path
) -> None:
    result = {}
    for steps in (1, 40):
        out = tmp_path / f"{steps}.safetensors"
        outcome = learn(steps, out)
        result[steps] = load_motion(out).training["held_out"]
    for loss in ("rec", "ld", "align"):
        assert result[40][loss] < 0.9 * result[1][loss]
    assert "30 windows of 6 takes by 1 speaker (1)" in outcome.sentences[0]


PRIOR = {"kl", "rec", "vrec"}
DENOISER = {"ld"}
ALIGNED = {"align", "valign"}


@pytest.mark.parametrize(
    ("ablation", "first", "last", "measured"),
    [
        (None, PRIOR | DENOISER | ALIGNED, DENOISER, PRIOR | DENOISER | ALIGNED),
        ("disjoint", PRIOR, DENOISER, PRIOR | DENOISER | ALIGNED),
        ("without_alignment", PRIOR | DENOISER, DENOISER, PRIOR | DENOISER | ALIGNED),
        ("without_prior", DENOISER, DENOISER, DENOISER | ALIGNED),
    ],
)
def test_an_ablation_trains_in_stages_and_is_measured_by_all_losses(
    learn: Learn,
    tmp_path: Path,
    ablation: str | None,
    first: set[str],
    last: set[str],
    measured: set[str],
) -> None:
    out = tmp_path / "out.safetensors"
    outcome = learn(8, out, ablation=ablation)
    log = (tmp_path / "out.run" / "log.jsonl").read_text().splitlines()
    losses = [set(json.loads(line)) for line in log if "held_out" not in line]
    assert (losses[0] & MOTION_LOSSES.keys(), losses[7] & MOTION_LOSSES.keys()) == (first, last)
    result = load_motion(out)
    assert result.training["ablation"] == ablation
    assert set(result.training["held_out"]) == {"loss", *measured}
    alone = ablation == "without_prior"
    assert result.model.prior.latent_shape == ((FRAMES, 333) if alone else (2, 16))
    assert ("reconstructed" in outcome.sentences[1]) != alone


def test_emotion_and_style_are_given_by_name_at_the_chosen_rate(
    takes: PreparedTakes, monkeypatch: pytest.MonkeyPatch
) -> None:
    losses = Mock(return_value={})
    monkeypatch.setattr("generators.amuse.train.motion_losses", losses)
    windows = Windows(takes, split="train", frames=FRAMES, stride=FRAMES)
    task = MotionTask(
        config=replace(MOTION, frames=FRAMES),
        weights=MOTION_LOSSES,
        align_steps=5,
        named=0.5,
        means={"emotion": {"": torch.full((8,), 99.0)}, "style": {"another": torch.zeros(8)}},
        training=windows,
        held_out=Windows(takes, split="validation", frames=FRAMES, stride=FRAMES),
    )
    network = task.network()
    task.losses(network, np.arange(len(windows)).repeat(20), "")
    task.validation(network)
    learned, measured = (call.args[2] for call in losses.call_args_list)
    content, emotion, style = learned
    assert torch.equal(content, style)
    by_name = (emotion == 99).all(dim=2)
    assert float(by_name.float().mean()) == pytest.approx(0.5, abs=0.1)
    assert torch.equal(emotion[~by_name], content[~by_name])
    assert not (measured[1] == 99).any()


def test_training_without_a_speech_model_is_refused(learn: Learn, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none is named.*--speech-model FILE"):
        learn(1, tmp_path / "out.safetensors", speech_model=None)
    with pytest.raises(InputError, match="weights, but not of AMUSE's speech model"):
        learn(1, tmp_path / "out.safetensors", speech_model=str(tmp_path / "motion.safetensors"))


def test_each_window_gets_the_latents_of_its_speech(tmp_path: Path) -> None:
    times = np.arange(3 * 16_000) / 16_000
    samples = np.where(times < 2, np.sin(900 * times), np.sin(6000 * times)).astype(np.float32)
    write_wav(tmp_path / "a.wav", Audio(samples, 16_000))
    network = load_speech(written_networks(tmp_path).speech_model)
    take = take_named("a", tmp_path)
    result = speech_latents(network, "x", frames=30, stride=30).compute(take)
    assert result.shape == (90, 24)
    assert (result[:30] == result[0]).all()
    same, other = (np.linalg.norm(result[0] - result[frame]) for frame in (30, 89))
    assert same < 0.2 * other
    # The device "meta" holds no values: what was computed there cannot be read back.
    with pytest.raises(NotImplementedError, match="meta tensor"):
        speech_latents(network, "x", frames=30, stride=30, device="meta").compute(take)
