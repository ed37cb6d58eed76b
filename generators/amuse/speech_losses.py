"""What AMUSE's speech model learns by (Chhatre et al. 2024, appendix B.4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional

from generators.amuse.speech import SpeechDecoder, SpeechModel

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
    emotions: Tensor,
    styles: Tensor,
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
    emotions, styles : Tensor
        (batch, 4) classes.
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
        parts["emo"] = functional.cross_entropy(emotion_logits, emotions.flatten())
    if counted.style:
        parts["sty"] = functional.cross_entropy(style_logits, styles.flatten())
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
