"""Sizes of AMUSE's networks; `AMUSE` and `SPEECH` are those of the released checkpoints.

Chhatre et al., CVPR 2024, sections 3 and 4 and appendix B. Where the paper and the release differ,
the release's value stands here, with the paper's beside it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True, kw_only=True)
class MotionConfig:
    """Sizes of the motion prior and of the latent denoiser.

    Attributes
    ----------
    motion_width : int
        Values of a frame: 55 joint rotations in 6D and the translation. The paper's upper body has
        47 joints and no translation, 282 values.
    frames : int
        Frames of a window, ten seconds at 30 fps.
    width : int
        Width of the transformers and of the latent. The paper says 1024.
    feed_forward, heads, layers : int
        Of the transformers; `layers` is odd, since the first half is told to the second.
    condition_width : int
        Width of each of the latents of content, emotion and style.
    longest : int
        Places that the learned positions know.
    dropout : float
        While training.
    """

    motion_width: int = 333
    frames: int = 300
    width: int = 128
    feed_forward: int = 512
    heads: int = 4
    layers: int = 9
    condition_width: int = 256
    longest: int = 500
    dropout: float = 0.1


@dataclass(frozen=True, kw_only=True)
class SpeechConfig:
    """Sizes of the speech disentanglement model.

    Attributes
    ----------
    frames, bands : int
        Of the filterbank: frames of 10 ms, mel bands.
    patch_stride : int
        Frames and bands from one patch of 16 × 16 to the next.
    width, feed_forward, heads, layers : int
        Of each of the three encoders (DeiT-base).
    latent : int
        Width of each latent.
    emotions, styles : int
        Classes told apart: emotions, and speakers.
    decoder_width, decoder_hidden : int
        Width of the decoder's transformer, and of the layer before the filterbank.
    decoder_feed_forward, decoder_heads, fusion_layers, decoder_layers : int
        Of the fusion and of the decoder.
    dropout : float
        Of the fusion and of the decoder, while training.
    """

    frames: int = 1024
    bands: int = 128
    patch_stride: int = 10
    width: int = 768
    feed_forward: int = 3072
    heads: int = 12
    layers: int = 12
    latent: int = 256
    emotions: int = 8
    styles: int = 30
    decoder_width: int = 512
    decoder_hidden: int = 1024
    decoder_feed_forward: int = 2048
    decoder_heads: int = 4
    fusion_layers: int = 2
    decoder_layers: int = 4
    dropout: float = 0.1


AMUSE: Final = MotionConfig()
SPEECH: Final = SpeechConfig()
