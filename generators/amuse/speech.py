"""AMUSE's speech disentanglement: content, emotion and style.

Chhatre et al., CVPR 2024, section 3.2 and appendix B: three audio spectrogram transformers encode a
filterbank; a fusion and a decoder reconstruct it from their three latents.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import torch
from scipy.fft import dct
from torch import Tensor, nn
from torch.nn import functional

from generators.amuse.config import PARTS, SpeechConfig

# transformers is imported where it is used: it takes seconds.
if TYPE_CHECKING:
    from transformers import ASTConfig


class SpeechOutput(NamedTuple):
    """The speech model's output for filterbanks, one row each.

    Attributes
    ----------
    content, emotion, style : Tensor
        Latents, (batch, latent).
    reconstruction : Tensor
        Filterbanks reconstructed from the three latents, (batch, frames, bands).
    emotion_logits, style_logits : Tensor
        Logits of the classes, (batch, classes).
    """

    content: Tensor
    emotion: Tensor
    style: Tensor
    reconstruction: Tensor
    emotion_logits: Tensor
    style_logits: Tensor


def ast_config(config: SpeechConfig) -> ASTConfig:
    """Return the sizes of an encoder's transformer."""
    from transformers import ASTConfig

    return ASTConfig(
        hidden_size=config.width,
        num_hidden_layers=config.layers,
        num_attention_heads=config.heads,
        intermediate_size=config.feed_forward,
        max_length=config.frames,
        num_mel_bins=config.bands,
        time_stride=config.patch_stride,
        frequency_stride=config.patch_stride,
        layer_norm_eps=1e-6,
    )


class SpeechEncoder(nn.Module):
    """One of the three encoders, E_c, E_e or E_s, with a head if it classifies."""

    def __init__(self, config: SpeechConfig, classes: int | None = None) -> None:
        from transformers import ASTModel

        super().__init__()
        self.transformer = ASTModel(ast_config(config))
        self.feature_head = nn.Sequential(
            nn.LayerNorm(config.width), nn.Linear(config.width, config.latent)
        )
        self.by_latent = config.classified == "latent"
        head_width = config.latent if self.by_latent else config.width
        self.class_head = (
            None
            if classes is None
            else nn.Sequential(nn.LayerNorm(head_width), nn.Linear(head_width, classes))
        )

    def forward(self, filterbank: Tensor) -> tuple[Tensor, Tensor | None]:
        """Return the latents (batch, latent) of filterbanks, and the classes' logits."""
        tokens = self.transformer(filterbank).last_hidden_state
        latent: Tensor = self.feature_head(tokens[:, 2:].mean(dim=1))
        if self.class_head is None:
            return latent, None
        return latent, self.class_head(latent if self.by_latent else tokens[:, :2].mean(dim=1))


def _layers(config: SpeechConfig, width: int, count: int) -> nn.TransformerEncoder:
    sizes = (width, config.decoder_heads, config.decoder_feed_forward, config.dropout)
    layer = nn.TransformerEncoderLayer(*sizes, batch_first=True)
    return nn.TransformerEncoder(layer, count, norm=nn.LayerNorm(width), enable_nested_tensor=False)


class SpeechDecoder(nn.Module):
    """Fusion and decoder D: reconstructs a filterbank from three latents.

    In the released network, each speech of a batch attends to the others. Here it does not.
    """

    def __init__(self, config: SpeechConfig) -> None:
        super().__init__()
        fused_width, width, hidden = 3 * config.latent, config.decoder_width, config.decoder_hidden
        self.shape = (config.frames, config.bands)
        self.fusion = _layers(config, fused_width, config.fusion_layers)
        self.narrow = nn.Linear(fused_width, width)
        self.decoder = _layers(config, width, config.decoder_layers)
        self.projection = nn.Sequential(
            nn.Linear(width, hidden), nn.ReLU(), nn.Linear(hidden, config.frames * config.bands)
        )

    def forward(self, content: Tensor, emotion: Tensor, style: Tensor) -> Tensor:
        """Return filterbanks (batch, frames, bands) from latents (batch, latent)."""
        fused = self.narrow(self.fusion(torch.cat([emotion, style, content], dim=-1)[:, None]))
        rebuilt: Tensor = self.projection(self.decoder(fused)[:, 0])
        return rebuilt.view(-1, *self.shape)


class SpeechModel(nn.Module):
    """The speech disentanglement model: three encoders and the decoder."""

    parts: Final = PARTS

    def __init__(self, config: SpeechConfig) -> None:
        super().__init__()
        self.config = config
        self.content = SpeechEncoder(config)
        self.emotion = SpeechEncoder(config, config.emotions)
        self.style = SpeechEncoder(config, config.styles)
        self.decoder = SpeechDecoder(config)

    def latent(self, part: str, filterbank: Tensor) -> Tensor:
        """Return one latent (batch, latent) of filterbanks; the other encoders do not run."""
        latent: Tensor = self.get_submodule(part)(filterbank)[0]
        return latent

    def forward(self, filterbank: Tensor) -> SpeechOutput:
        """Return latents, reconstructions and logits of filterbanks (batch, frames, bands)."""
        content, _ = self.content(filterbank)
        emotion, emotion_logits = self.emotion(filterbank)
        style, style_logits = self.style(filterbank)
        rebuilt = self.decoder(content, emotion, style)
        return SpeechOutput(content, emotion, style, rebuilt, emotion_logits, style_logits)


class SpeechAutoencoder(nn.Module):
    """Eight linear layers around one latent of cepstral coefficients (appendix C.3).

    It replaces the speech model in an ablation. Its latent counts as content; no part of the speech
    can be exchanged.
    """

    parts: Final = PARTS[:1]

    def __init__(self, config: SpeechConfig) -> None:
        super().__init__()
        self.config = config
        cosines = dct(np.eye(config.bands), norm="ortho", axis=0)[: config.mfcc].T
        self.register_buffer("cosines", torch.from_numpy(cosines).float(), persistent=False)
        values, hidden = config.frames * config.mfcc, config.decoder_hidden
        self.encoder = _linear_layers(values, hidden, config.latent)
        self.decoder = _linear_layers(config.latent, hidden, values)

    def coefficients(self, filterbank: Tensor) -> Tensor:
        """Return the cepstral coefficients (batch, frames · mfcc) of filterbanks."""
        return (filterbank @ self.get_buffer("cosines")).flatten(1)

    def latent(self, part: str, filterbank: Tensor) -> Tensor:
        """Return the latent (batch, latent) of filterbanks (batch, frames, bands)."""
        latent: Tensor = self.encoder(self.coefficients(filterbank))
        return latent

    def reconstruction_error(self, filterbank: Tensor) -> Tensor:
        """Return the mean absolute error of the reconstructed coefficients."""
        coefficients = self.coefficients(filterbank)
        return functional.l1_loss(self.decoder(self.encoder(coefficients)), coefficients)


def _linear_layers(first: int, hidden: int, last: int) -> nn.Sequential:
    sizes = (first, hidden, hidden, hidden, last)
    layers = [(nn.Linear(*pair), nn.ReLU()) for pair in pairwise(sizes)]
    return nn.Sequential(*[layer for pair in layers for layer in pair][:-1])


AnySpeechModel = SpeechModel | SpeechAutoencoder


def make_speech_model(config: SpeechConfig) -> AnySpeechModel:
    """Return an untrained speech model, or the auto-encoder that replaces it."""
    return SpeechAutoencoder(config) if config.mfcc else SpeechModel(config)
