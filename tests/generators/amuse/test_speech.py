"""The speech disentanglement model."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import pytest
import torch

from generators.amuse.speech import SpeechAutoencoder, SpeechEncoder, SpeechModel
from tests.generators.amuse.small_networks import SPEECH

SMALL = replace(
    SPEECH, frames=64, bands=32, patch_stride=16, emotions=3, styles=4, decoder_hidden=16
)


@pytest.fixture(scope="module")
def model() -> SpeechModel:
    torch.manual_seed(4)
    return SpeechModel(SMALL).eval()


def test_latents_of_speech_do_not_depend_on_the_batch(model: SpeechModel) -> None:
    filterbanks = torch.randn(3, 64, 32, generator=torch.Generator().manual_seed(1))
    with torch.inference_mode():
        together, alone = model(filterbanks), model(filterbanks[1:2])
    for name, result in together._asdict().items():
        torch.testing.assert_close(result[1:2], getattr(alone, name), msg=name)


@pytest.mark.parametrize("classified", ["tokens", "latent"])
def test_the_emotions_classifier_may_be_the_latent_itself(
    classified: Literal["tokens", "latent"],
) -> None:
    torch.manual_seed(4)
    encoder = SpeechEncoder(replace(SMALL, classified=classified), classes=3).eval()
    _, logits = encoder(torch.randn(2, 64, 32))
    assert logits is not None
    logits.sum().backward()
    weight = encoder.feature_head[1].weight
    assert (weight.grad is not None) == (classified == "latent")


def test_the_autoencoder_reads_the_discrete_cosine_transform() -> None:
    model = SpeechAutoencoder(replace(SMALL, mfcc=3))
    rows = torch.ones(1, 64, 32)
    result = model.coefficients(rows).view(64, 3)
    assert torch.allclose(result[:, 0], torch.full((64,), 32**0.5), rtol=1e-5)
    assert float(result[:, 1:].abs().max()) < 1e-4
    assert sum(isinstance(one, torch.nn.Linear) for one in model.modules()) == 8
