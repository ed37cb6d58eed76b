"""What AMUSE's motion networks learn by (Chhatre et al. 2024, section 3.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from generators.amuse.config import FRAME_RATE, STEPS
from generators.amuse.model import Denoiser, MotionModel
from training.diffusion import SCALED_LINEAR


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
