"""What AMUSE's networks learn by."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import pytest
import torch

from generators.amuse.losses import (
    MASKED_BANDS,
    MASKED_ROWS,
    OF_ALIGNMENT,
    OF_PRIOR,
    OTHER_CONTENT,
    OTHER_STYLE,
    LossWeights,
    SpeechLosses,
    augmented,
    motion_losses,
    speech_losses,
)
from generators.amuse.model import MotionModel
from generators.amuse.speech import SpeechModel
from tests.generators.amuse.small_networks import MOTION
from tests.generators.amuse.test_speech import SMALL as SPEECH

SMALL = replace(MOTION, frames=12)
DENOISER_ALONE = LossWeights().without(*OF_PRIOR, *OF_ALIGNMENT)


@pytest.fixture(name="model")
def _model() -> MotionModel:
    torch.manual_seed(5)
    return MotionModel(SMALL).eval()


def _losses(
    model: MotionModel, weights: LossWeights, draws: tuple[int, ...] = (0, 1)
) -> dict[str, torch.Tensor]:
    random = torch.Generator().manual_seed(2)
    motion = torch.randn(2, 12, 333, generator=random)
    latents = [torch.randn(2, 1, 8, generator=random) for _ in range(3)]
    noise = torch.randn(4, 2, 1, MOTION.width, generator=random)[[0, 1, *(2 + n for n in draws)]]
    steps = torch.tensor([[3, 700], [0, 500]])[list(draws)]
    return motion_losses(model, motion, latents, noise, steps, weights)


def _taught(model: MotionModel, weights: LossWeights) -> set[str]:
    """Which networks get a gradient of the loss."""
    model.zero_grad()
    _losses(model, weights)["loss"].backward()
    parts = {
        "encoder": model.prior.encoder,
        "decoder": model.prior.decoder,
        "denoiser": model.denoiser,
    }
    return {
        name
        for name, part in parts.items()
        if any(weight.grad is not None and weight.grad.any() for weight in part.parameters())
    }


_NOTHING = LossWeights(rec=0, vrec=0, kl=0, ld=0, align=0, valign=0)


@pytest.mark.parametrize(
    ("name", "taught"),
    [
        ("rec", {"encoder", "decoder"}),
        ("vrec", {"encoder", "decoder"}),
        ("velocity", {"encoder", "decoder"}),
        ("kl", {"encoder"}),
        ("ld", {"denoiser"}),
        ("align", {"decoder"}),
        ("valign", {"decoder"}),
    ],
)
def test_each_loss_teaches_the_networks_that_the_paper_says(
    model: MotionModel, name: str, taught: set[str]
) -> None:
    assert _taught(model, replace(_NOTHING, **{name: 1.0})) == taught


def test_the_loss_is_the_weighted_sum_of_its_parts(model: MotionModel) -> None:
    weights = LossWeights(rec=2, vrec=3, kl=1e-4, ld=5, align=0.5, valign=0.25, velocity=0.1)
    losses = {name: float(value.detach()) for name, value in _losses(model, weights).items()}
    parts = sum(getattr(weights, name) * losses[name] for name in losses if name != "loss")
    assert losses["loss"] == pytest.approx(parts, rel=1e-5)


def test_the_latents_distance_is_that_of_two_normal_laws(model: MotionModel) -> None:
    motion = torch.randn(2, 12, 333, generator=torch.Generator().manual_seed(2))
    mu, std = model.prior.encode(motion)
    found = torch.distributions.kl_divergence(
        torch.distributions.Normal(mu, std), torch.distributions.Normal(0.0, 1.0)
    )
    assert float(_losses(model, LossWeights())["kl"].detach()) == pytest.approx(
        float(found.mean().detach()), rel=1e-5
    )


def test_losses_that_count_nothing_are_not_computed(model: MotionModel) -> None:
    weights = LossWeights(velocity=0.1)
    prior = {"loss", "kl", "rec", "vrec", "velocity"}
    assert set(_losses(model, weights.without(*OF_ALIGNMENT))) == {*prior, "ld"}
    assert set(_losses(model, weights.without("ld", *OF_ALIGNMENT))) == prior
    assert set(_losses(model, DENOISER_ALONE)) == {"loss", "ld"}


@pytest.mark.parametrize("predicts", ["eps", "v"])
@torch.inference_mode()
def test_each_draw_of_noise_counts_alike(predicts: Literal["eps", "v"]) -> None:
    torch.manual_seed(5)
    model = MotionModel(replace(SMALL, predicts=predicts)).eval()
    alone = [_losses(model, DENOISER_ALONE, draws=(draw,))["ld"] for draw in range(2)]
    together = _losses(model, DENOISER_ALONE)["ld"]
    assert float(together) == pytest.approx(float(sum(alone)) / 2)


def _speech_losses(counted: SpeechLosses, heard: torch.Tensor) -> dict[str, float]:
    torch.manual_seed(1)
    model = SpeechModel(SPEECH).eval()
    classes = torch.tensor([[[0, 0, 0, 0]], [[0, 0, 1, 1]]])
    losses = speech_losses(model, heard, heard, classes, counted)
    return {name: float(value.detach()) for name, value in losses.items()}


def _four() -> torch.Tensor:
    return torch.randn(1, 4, 64, 32, generator=torch.Generator().manual_seed(3))


def test_the_index_maps_are_those_printed_in_the_paper() -> None:
    assert tuple((6 - k) % 4 for k in range(1, 5)) == OTHER_CONTENT
    assert tuple((1 + k) % 4 for k in range(1, 5)) == OTHER_STYLE


def test_the_loss_of_speech_is_the_sum_of_seven() -> None:
    losses = _speech_losses(SpeechLosses(), _four())
    parts = {name: value for name, value in losses.items() if name != "loss"}
    assert set(parts) == {"self", "con", "xcon", "emo", "xemo", "sty", "xsty"}
    assert losses["loss"] == pytest.approx(sum(parts.values()), rel=1e-5)


@pytest.mark.parametrize(
    ("counted", "left_out"),
    [
        (SpeechLosses(style=False), {"sty", "xsty"}),
        (SpeechLosses(emotion=False), {"emo", "xemo"}),
    ],
)
def test_an_ablation_drops_two_speech_losses(counted: SpeechLosses, left_out: set[str]) -> None:
    full, fewer = (_speech_losses(one, _four()) for one in (SpeechLosses(), counted))
    assert set(full) - set(fewer) == left_out


def test_swapping_parts_of_equal_speech_costs_nothing() -> None:
    losses = _speech_losses(SpeechLosses(), _four()[:, :1].expand(-1, 4, -1, -1))
    assert losses["con"] == pytest.approx(0, abs=1e-6)
    for name in ("xcon", "xemo", "xsty"):
        assert losses[name] == pytest.approx(losses["self"], rel=1e-5)


def test_contents_gain_nothing_by_all_coming_nearer() -> None:
    torch.manual_seed(1)
    model = SpeechModel(SPEECH).eval()
    classes = torch.tensor([[[0, 0, 0, 0]], [[0, 0, 1, 1]]])
    found = []
    for _ in range(2):
        losses = speech_losses(model, _four(), _four(), classes, SpeechLosses())
        found.append(float(losses["con"].detach()))
        linear = model.content.feature_head[1]
        with torch.no_grad():
            linear.weight *= 10
    assert found[0] == pytest.approx(found[1], rel=0.1)


def test_masks_stay_within_their_shares_and_hide_the_same_from_both() -> None:
    torch.manual_seed(2)
    filterbanks = torch.ones(40, 1024, 128)
    heard, target = augmented(filterbanks)
    hidden = target == 0
    rows, bands = hidden.all(dim=2).sum(dim=1), hidden.all(dim=1).sum(dim=1)
    assert int(rows.max()) <= round(MASKED_ROWS * 1024)
    assert int(bands.max()) <= round(MASKED_BANDS * 128)
    assert int(rows.max()) > 0
    assert int(bands.max()) > 0
    # What is heard is noisy by a tenth at most, and shifted.
    assert float((heard.sum() - target.sum()) / heard.numel()) < 0.1
    assert float(heard.max()) <= 1.1
