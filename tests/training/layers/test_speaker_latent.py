"""The latent of who speaks is held near a normal one, and differs between speakers."""

from __future__ import annotations

import pytest
import torch

from training.layers.speaker_latent import SpeakerEncoder, latent_loss


def test_a_normal_latent_costs_nothing() -> None:
    nothing = torch.zeros(2, 4)
    assert float(latent_loss([(nothing, nothing)])) == 0
    assert float(latent_loss([(nothing + 1, nothing)])) == pytest.approx(0.5)


def test_speakers_have_latents_of_their_own_and_mixtures_lie_between_them() -> None:
    torch.manual_seed(1)
    encode = SpeakerEncoder(3, 4)
    means, variances = encode(torch.eye(3))
    assert means.shape == variances.shape == (3, 4)
    assert (means[0] - means[1]).abs().max() > 1e-3
    between, _ = encode(torch.tensor([[0.5, 0.5, 0.0]]))
    torch.testing.assert_close(between[0], means[:2].mean(dim=0))
