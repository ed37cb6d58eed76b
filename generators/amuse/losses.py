"""AMUSE's losses (Chhatre et al. 2024, section 3.3 and appendix B.4)."""

from collections.abc import Collection, Mapping, Sequence
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from generators.amuse.config import FRAME_RATE, PARTS, STEPS
from generators.amuse.model import Denoiser, MotionModel
from generators.amuse.speech import SpeechDecoder, SpeechModel, SpeechOutput
from training.diffusion import SCALED_LINEAR

Weights = Mapping[str, float]
"""Weights of losses by name; losses without a weight are not computed."""

MOTION_LOSSES: Final = {"rec": 1.0, "vrec": 1.0, "kl": 1e-4, "ld": 1.0, "align": 1.0, "valign": 1.0}
"""Weights of the motion networks' losses, as in the paper.

``rec`` and ``vrec``, L_rec and L_Vrec, compare the prior's reconstruction with the motion, and the
body's points in both. ``kl``, L_KL, is the latent's divergence from a standard normal distribution:
a mean over its values, like the other losses; a sum, as the paper prints it, outweighs all
movement. ``ld``, L_LD, is the denoiser's error of the noise. ``align`` and ``valign``, L_align and
L_Valign, compare as ``rec`` and ``vrec`` do, but the motion decoded from a fully denoised latent. A
small prior also needs ``velocity``, the reconstruction's error of each value's change per second;
without it, its motion trembles.
"""

PRIOR_LOSSES: Final = ("rec", "vrec", "kl", "velocity")
ALIGNMENT_LOSSES: Final = ("align", "valign")

ABLATED_LOSSES: Final[Mapping[str, Sequence[str]]] = {
    "prior": ("ld", *ALIGNMENT_LOSSES),
    "denoiser": (*PRIOR_LOSSES, *ALIGNMENT_LOSSES),
    "without_alignment": ALIGNMENT_LOSSES,
    "without_prior": (*PRIOR_LOSSES, *ALIGNMENT_LOSSES),
    "emotion_only": ("sty", "xsty"),
    "style_only": ("emo", "xemo"),
}
"""Losses that are omitted if only prior or denoiser is trained, and in ablations."""

SPEECH_LOSSES: Final = dict.fromkeys(("con", "self", "xcon", "xemo", "xsty", "emo", "sty"), 1.0)
"""Weights of the speech model's losses: L_con, L_self, and so on."""

OTHER_CONTENT: Final = (1, 0, 3, 2)
"""For each of a quadruple, one of the same speaker and another text: j(k) = (6 - k) mod 4 + 1."""

OTHER_STYLE: Final = (2, 3, 0, 1)
"""For each of a quadruple, one of the same text by the other speaker: j(k) = (1 + k) mod 4 + 1."""

CROSSED: Final = {
    "xcon": ("content", OTHER_STYLE),
    "xemo": ("emotion", OTHER_CONTENT),
    "xsty": ("style", OTHER_CONTENT),
}
"""The latent that is exchanged in each cross-reconstruction, and its sources in the quadruple."""

_SMALLEST_DISTANCE: Final = 1e-6


def without(weights: Weights, *names: str) -> Weights:
    """Return the weights without some losses, or without those of keys of `ABLATED_LOSSES`."""
    dropped = {loss for name in names for loss in ABLATED_LOSSES.get(name, (name,))}
    return {name: weight for name, weight in weights.items() if name not in dropped}


def _weighted_sum(parts: Mapping[str, Tensor], weights: Weights) -> dict[str, Tensor]:
    """Return the parts that have a weight, and their weighted sum as ``loss``."""
    counted = {name: part for name, part in parts.items() if name in weights}
    total = torch.stack([weights[name] * part for name, part in counted.items()]).sum()
    return {"loss": total, **counted}


def motion_losses(
    model: MotionModel,
    motion: Tensor,
    latents: Sequence[Tensor],
    noise: Tensor,
    timestep: Tensor,
    weights: Weights,
    steps: int = STEPS,
) -> dict[str, Tensor]:
    """Return the loss of the three-step pass, and its parts.

    First the prior encodes and decodes the motion. Then its latent, without gradients, gets noise
    that the denoiser predicts. Last, a latent is denoised from pure noise, without gradients, and
    decoded: the error of its motion trains the decoder.

    Parameters
    ----------
    model : MotionModel
        The networks.
    motion : Tensor
        (batch, frames, motion width).
    latents : sequence of Tensor
        Content, emotion and style, (batch, 1, condition width) each.
    noise : Tensor
        (2 + draws, batch, tokens, width): noise of the prior's latent, noise to denoise from, and
        noise of the diffusion.
    timestep : Tensor
        (draws, batch) diffusion steps.
    weights : mapping of str to float
        Weights of the losses: see `MOTION_LOSSES`.
    steps : int
        Number of DDIM steps in the third pass.

    Returns
    -------
    dict of str to Tensor
        ``loss``, and the unweighted losses that have a weight, by name.
    """
    mu, std = model.prior.encode(motion)
    z = mu + std * noise[0]
    parts = {"kl": (mu.square() + std.square() - 2 * std.log() - 1).mean() / 2}
    points = model.points(motion) if weights.keys() & {"vrec", "valign"} else None

    def compare(z: Tensor, name: str, points_name: str) -> Tensor:
        """Return the motion of latents; add the errors of it and of its points to `parts`."""
        decoded = model.prior.decode(z, motion.shape[1])
        parts[name] = functional.smooth_l1_loss(decoded, motion)
        if points is not None and points_name in weights:
            parts[points_name] = functional.smooth_l1_loss(model.points(decoded), points)
        return decoded

    if weights.keys() & {"rec", "vrec", "velocity"}:
        velocity, true_velocity = (
            FRAME_RATE * values.diff(dim=1) for values in (compare(z, "rec", "vrec"), motion)
        )
        parts["velocity"] = functional.smooth_l1_loss(velocity, true_velocity)
    if "ld" in weights:
        parts["ld"] = _denoising_loss(model.denoiser, z.detach(), latents, noise[2:], timestep)
    if weights.keys() & set(ALIGNMENT_LOSSES):
        with torch.no_grad():
            z = model.sample(noise[1], latents, steps)
        compare(z, "align", "valign")
    return _weighted_sum(parts, weights)


def _denoising_loss(
    denoiser: Denoiser, z: Tensor, latents: Sequence[Tensor], noise: Tensor, timestep: Tensor
) -> Tensor:
    """Return the denoiser's error for each draw of noise (draws, batch, …)."""
    draws, t, eps = len(noise), timestep.flatten(), noise.flatten(0, 1)
    z = z.repeat(draws, 1, 1)
    conditions = [latent.repeat(draws, 1, 1) for latent in latents]
    predicted = denoiser.predict(SCALED_LINEAR.x_t(z, eps, t), t, *conditions)
    target = eps if denoiser.config.predicts == "eps" else SCALED_LINEAR.v(z, eps, t)
    return functional.mse_loss(predicted, target)


def speech_losses(
    model: SpeechModel, filterbanks: Tensor, target: Tensor, classes: Tensor, weights: Weights
) -> dict[str, Tensor]:
    """Return the loss of quadruples, and its parts.

    Parameters
    ----------
    model : SpeechModel
        The network.
    filterbanks, target : Tensor
        (4 batch, frames, bands), quadruples in the order of `quadruples`: input of the encoders,
        and target of the decoder.
    classes : Tensor
        (2, 4 batch), class numbers of emotions and of speakers.
    weights : mapping of str to float
        Weights of the losses: see `SPEECH_LOSSES`.

    Returns
    -------
    dict of str to Tensor
        ``loss``, and the losses that have a weight. Distances are mean absolute differences over
        latents or filterbanks. ``con``, the distance of a text's contents by two speakers, is
        divided by the distance of two texts' contents by one speaker. As printed in the paper, it
        is smallest if all contents are equal, which they were after some hundred steps.
    """
    output: SpeechOutput = model(filterbanks)
    content = output.content.view(-1, 4, output.content.shape[-1])
    distance = functional.l1_loss(content[:, ::2], content[:, 1::2]).clamp_min(_SMALLEST_DISTANCE)
    parts = {
        "con": functional.l1_loss(content[:, :2], content[:, 2:]) / distance,
        **reconstruction_errors(model.decoder, output, target, weights),
        "emo": functional.cross_entropy(output.emotion_logits, classes[0]),
        "sty": functional.cross_entropy(output.style_logits, classes[1]),
    }
    return _weighted_sum(parts, weights)


def reconstruction_errors(
    decoder: SpeechDecoder, output: SpeechOutput, target: Tensor, names: Collection[str]
) -> dict[str, Tensor]:
    """Return the errors of filterbanks reconstructed from latents of quadruples (Table A.2).

    Parameters
    ----------
    decoder : SpeechDecoder
        The network's decoder.
    output : SpeechOutput
        The quadruples' latents and reconstructions.
    target : Tensor
        (4 batch, frames, bands), the filterbanks to reconstruct.
    names : collection of str
        Names of the cross-reconstructions to compute.

    Returns
    -------
    dict of str to Tensor
        Mean absolute differences: ``self`` with each speech's own latents; ``xcon``, ``xemo`` and
        ``xsty`` with one latent of another member of the quadruple.
    """
    errors = {"self": functional.l1_loss(output.reconstruction, target)}
    for name, (part, order) in CROSSED.items():
        if name in names:
            latents = dict(zip(PARTS, output[:3], strict=True))
            quadruples = latents[part].view(-1, 4, latents[part].shape[-1])
            latents[part] = quadruples[:, list(order)].flatten(0, 1)
            errors[name] = functional.l1_loss(decoder(**latents), target)
    return errors
