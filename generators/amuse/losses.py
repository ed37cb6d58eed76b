"""What AMUSE's networks learn by (Chhatre et al. 2024, section 3.3 and appendix B.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from generators.amuse.config import FRAME_RATE, STEPS
from generators.amuse.model import Denoiser, MotionModel
from generators.amuse.speech import SpeechDecoder, SpeechModel
from training.diffusion import SCALED_LINEAR

OTHER_CONTENT: Final = (1, 0, 3, 2)
"""For each of the four, one of the same speaker and another text: j(k) = [(6 - k) mod 4] + 1."""

OTHER_STYLE: Final = (2, 3, 0, 1)
"""For each of the four, one of the same text by the other speaker: j(k) = [(1 + k) mod 4] + 1."""

MASKED_BANDS: Final = 24 / 128
MASKED_ROWS: Final = 96 / 1024
"""Largest shares of bands and of rows that are masked (Park et al. 2019)."""

_LEAST_APART: Final = 1e-6
_NOISE: Final = 0.1
_SHIFT: Final = 10


@dataclass(frozen=True, kw_only=True)
class LossWeights:
    """How much each loss counts; those of 0 are not computed.

    Attributes
    ----------
    rec, vrec : float
        Of the prior's reconstruction, L_rec, and of the body's points in it, L_Vrec.
    kl : float
        Of the latent's distance from a standard normal law, L_KL: a mean over its values, as the
        other losses are means. A sum, as the paper prints it, outweighs all movement.
    ld : float
        Of the noise that the denoiser does not find, L_LD.
    align, valign : float
        Of the motion that is decoded from a fully denoised latent, L_align, and of the body's
        points in it, L_Valign.
    velocity : float
        Of what the reconstruction misses of the change of each value in a second. The paper has
        none; a small prior trembles without it.
    """

    rec: float = 1.0
    vrec: float = 1.0
    kl: float = 1e-4
    ld: float = 1.0
    align: float = 1.0
    valign: float = 1.0
    velocity: float = 0.0

    def without(self, *names: str) -> LossWeights:
        """Return the weights with those of some losses 0."""
        return replace(self, **dict.fromkeys(names, 0.0))


OF_PRIOR: Final = ("rec", "vrec", "kl", "velocity")
OF_ALIGNMENT: Final = ("align", "valign")


def motion_losses(
    model: MotionModel,
    motion: Tensor,
    latents: Sequence[Tensor],
    noise: Tensor,
    timestep: Tensor,
    weights: LossWeights,
    steps: int = STEPS,
) -> dict[str, Tensor]:
    """Return the loss of the three-step pass, and its parts.

    First the prior codes and decodes the motion. Then its latent, of which no gradient is taken,
    gets noise for the denoiser to find. Last a latent is denoised from noise alone, without
    gradients, and decoded: what misses the motion then teaches the decoder.

    Parameters
    ----------
    model : MotionModel
        The networks.
    motion : Tensor
        (batch, frames, motion width).
    latents : sequence of Tensor
        Content, emotion and style, (batch, 1, condition width) each.
    noise : Tensor
        (2 + draws, batch, tokens, width): for the prior's latent, to denoise from, and for the
        diffusion.
    timestep : Tensor
        (draws, batch) diffusion steps.
    weights : LossWeights
        How the parts add up.
    steps : int
        Of DDIM in the third pass.

    Returns
    -------
    dict of str to Tensor
        ``loss``, and unweighted ``rec``, ``vrec``, ``velocity``, ``kl``, ``ld``, ``align``,
        ``valign``, of those that count.
    """
    mu, std = model.prior.encode(motion)
    z = mu + std * noise[0]
    parts: dict[str, Tensor] = {}
    points = model.points(motion) if weights.vrec or weights.valign else None

    def compare(z: Tensor, whole: str, surface: str) -> Tensor:
        """Return the motion of latents, and tell by how much it and its points miss the true."""
        decoded = model.prior.decode(z, motion.shape[1])
        parts[whole] = functional.smooth_l1_loss(decoded, motion)
        if points is not None and getattr(weights, surface):
            parts[surface] = functional.smooth_l1_loss(model.points(decoded), points)
        return decoded

    if weights.kl:
        parts["kl"] = (mu.square() + std.square() - 2 * std.log() - 1).mean() / 2
    if weights.rec or weights.vrec or weights.velocity:
        moves, moved = (FRAME_RATE * one.diff(dim=1) for one in (compare(z, "rec", "vrec"), motion))
        if weights.velocity:
            parts["velocity"] = functional.smooth_l1_loss(moves, moved)
    if weights.ld:
        parts["ld"] = _unpredicted(model.denoiser, z.detach(), latents, noise[2:], timestep)
    if weights.align or weights.valign:
        with torch.no_grad():
            z = model.sample(noise[1], latents, steps)
        compare(z, "align", "valign")
    total = sum(
        (getattr(weights, name) * part for name, part in parts.items()), motion.new_zeros(())
    )
    return {"loss": total, **parts}


def _unpredicted(
    denoiser: Denoiser, z: Tensor, latents: Sequence[Tensor], noise: Tensor, timestep: Tensor
) -> Tensor:
    """Return what the denoiser does not predict of each draw of noise (draws, batch, …)."""
    draws, t, eps = len(noise), timestep.flatten(), noise.flatten(0, 1)
    z = z.repeat(draws, 1, 1)
    told = [latent.repeat(draws, 1, 1) for latent in latents]
    predicted = denoiser.predict(SCALED_LINEAR.x_t(z, eps, t), t, *told)
    wanted = eps if denoiser.config.predicts == "eps" else SCALED_LINEAR.v(z, eps, t)
    return functional.mse_loss(predicted, wanted)


@dataclass(frozen=True, kw_only=True)
class SpeechLosses:
    """Which losses count besides L_self, L_con and L_xcon.

    Attributes
    ----------
    emotion, style : bool
        Whether L_emo and L_xemo, and L_sty and L_xsty, do (appendix B.6).
    """

    emotion: bool = True
    style: bool = True


def speech_losses(
    model: SpeechModel,
    heard: Tensor,
    target: Tensor,
    classes: Tensor,
    counted: SpeechLosses,
) -> dict[str, Tensor]:
    """Return the loss of quadruples, and its parts.

    Parameters
    ----------
    model : SpeechModel
        The network.
    heard, target : Tensor
        (batch, 4, frames, bands), in the order of `training.data.quadruples`: what the encoders
        are given, and what the decoder is to give.
    classes : Tensor
        (2, batch, 4), the numbers of emotions and of speakers.
    counted : SpeechLosses
        What is left out.

    Returns
    -------
    dict of str to Tensor
        ``loss``, the sum of the others: ``self``, ``con``, ``xcon``, ``emo``, ``xemo``, ``sty``,
        ``xsty``. Distances are mean absolute differences over latents or filterbanks. ``con``, how
        far a text's contents by two speakers are apart, is in units of how far those of two texts
        by one speaker are: as printed, it is least where all contents are one, and within some
        hundred steps they were.
    """
    batch = len(heard)
    flat = heard.flatten(0, 1)
    content, _ = model.content(flat)
    emotion, emotion_logits = model.emotion(flat)
    style, style_logits = model.style(flat)
    fours = content.view(batch, 4, -1)
    apart = functional.l1_loss(fours[:, ::2], fours[:, 1::2]).clamp_min(_LEAST_APART)
    parts = {
        "con": functional.l1_loss(fours[:, :2], fours[:, 2:]) / apart,
        **reconstruction_errors(
            model.decoder, (content, emotion, style), target.flatten(0, 1), counted
        ),
    }
    if counted.emotion:
        parts["emo"] = functional.cross_entropy(emotion_logits, classes[0].flatten())
    if counted.style:
        parts["sty"] = functional.cross_entropy(style_logits, classes[1].flatten())
    return {"loss": torch.stack(list(parts.values())).sum(), **parts}


def reconstruction_errors(
    decoder: SpeechDecoder,
    latents: tuple[Tensor, Tensor, Tensor],
    target: Tensor,
    counted: SpeechLosses,
) -> dict[str, Tensor]:
    """Return how much filterbanks miss that are rebuilt from latents of quadruples (Table A.2).

    Parameters
    ----------
    decoder : SpeechDecoder
        Of the network.
    latents : tuple of Tensor
        Content, emotion and style, (4 batch, latent) each.
    target : Tensor
        (4 batch, frames, bands), what is to be rebuilt.
    counted : SpeechLosses
        What is left out.

    Returns
    -------
    dict of str to Tensor
        Mean absolute differences: ``self``, of each speech's own latents; ``xcon``, ``xemo`` and
        ``xsty``, with one latent of another of the four.
    """
    content, emotion, style = latents
    inputs = {"self": latents, "xcon": (_swapped(content, OTHER_STYLE), emotion, style)}
    if counted.emotion:
        inputs["xemo"] = (content, _swapped(emotion, OTHER_CONTENT), style)
    if counted.style:
        inputs["xsty"] = (content, emotion, _swapped(style, OTHER_CONTENT))
    return {name: functional.l1_loss(decoder(*each), target) for name, each in inputs.items()}


def augmented(filterbanks: Tensor) -> tuple[Tensor, Tensor]:
    """Return what is heard of filterbanks (n, frames, bands), and what is to be rebuilt.

    Both are masked alike, up to the shares of the paper; what is heard is also shifted along the
    time by up to ten rows and noisy, as in AST's training. Chance is torch's.
    """
    count, frames, bands = filterbanks.shape
    rows = _band(count, frames, MASKED_ROWS)[:, :, None]
    columns = _band(count, bands, MASKED_BANDS)[:, None, :]
    masked = filterbanks.masked_fill((rows | columns).to(filterbanks.device), 0.0)
    shift = int(torch.randint(-_SHIFT, _SHIFT + 1, ()))
    noise = _NOISE * torch.rand(count, 1, 1) * torch.rand(filterbanks.shape)
    return torch.roll(masked + noise.to(filterbanks.device), shift, dims=1), masked


def _band(count: int, size: int, share: float) -> Tensor:
    """Return for each of `count` a run of places, at most a share of them, (count, size)."""
    width = torch.randint(0, max(1, round(share * size)) + 1, (count, 1))
    first = (torch.rand(count, 1) * (size - width + 1)).long()
    places = torch.arange(size)
    return (places >= first) & (places < first + width)


def _swapped(latents: Tensor, order: Sequence[int]) -> Tensor:
    """Return the latents (4 batch, latent) of others of the same four."""
    return latents.view(-1, 4, latents.shape[-1])[:, list(order)].flatten(0, 1)
