"""Sizes of AMUSE's networks; by default those of the released checkpoints.

Chhatre et al., CVPR 2024, sections 3 and 4 and appendix B. If the paper and the release differ, the
release's value is used here, and the paper's is mentioned.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from training.config import Preset, read_presets

FRAME_RATE: Final = 30
"""Frames of motion per second."""

STEPS: Final = 50
"""DDIM steps, of the 1000 diffusion steps that the denoiser learns."""

PARTS: Final = ("content", "emotion", "style")
"""The latents of disentangled speech."""

LABELS: Final[Mapping[str, str]] = {"emotion": "emotion", "style": "speaker"}
"""The fields of a take that label its emotion and its style."""


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
        Width of the transformers and of the latent. The paper has 1024.
    feed_forward, heads, layers : int
        Sizes of the transformers; `layers` is odd, since the first half feeds the second.
    condition_width : int
        Width of each of the latents of content, emotion and style.
    conditions : int
        Number of the speech's latents: 3, or 1 if the speech model does not disentangle it.
    prior : bool
        Whether a prior encodes motion; without it, the denoiser sees frames (Table A.3).
    tokens : int
        Number of tokens of a motion's latent, each as wide as the networks. The release has one,
        which captures little of the movement before it has been trained for days.
    log_variance : float
        Offset of the log variances of the latent that the prior predicts. A denoiser learns little
        from a latent that is half noise; an offset below 0 starts with less noise than the release.
    predicts : {'eps', 'v'}
        Prediction of the denoiser's layers: the noise, as released, or the velocity of Salimans &
        Ho 2022, from which the noise follows. At steps with little signal, a small error of the
        noise is a large error of the latent: after some hundred training steps, sampled latents are
        several times too large with noise, and of the right size with velocity.
    clip : float or None
        Largest absolute value of the latent that a DDIM step estimates. The release has 1, the
        default of its scheduler (diffusers); the paper mentions no limit.
    longest : int
        Number of learned positions.
    dropout : float
        Dropout in training.
    """

    motion_width: int = 333
    frames: int = 300
    width: int = 128
    feed_forward: int = 512
    heads: int = 4
    layers: int = 9
    condition_width: int = 256
    conditions: int = 3
    prior: bool = True
    tokens: int = 1
    log_variance: float = 0.0
    predicts: Literal["eps", "v"] = "eps"
    clip: float | None = None
    longest: int = 500
    dropout: float = 0.1


@dataclass(frozen=True, kw_only=True)
class SpeechConfig:
    """Sizes of the speech disentanglement model.

    Attributes
    ----------
    frames, bands : int
        Size of the filterbank: frames of 10 ms, mel bands.
    patch_stride : int
        Frames and bands from one patch of 16 × 16 to the next.
    width, feed_forward, heads, layers : int
        Sizes of each of the three encoders (DeiT-base).
    latent : int
        Width of each latent.
    emotions, styles : int
        Numbers of classes: emotions, and speakers.
    decoder_width, decoder_hidden : int
        Width of the decoder's transformer, and of the layer before the filterbank.
    decoder_feed_forward, decoder_heads, fusion_layers, decoder_layers : int
        Sizes of the fusion and of the decoder.
    dropout : float
        Dropout of the fusion and of the decoder, while training.
    classified : {'tokens', 'latent'}
        Inputs of the classifiers of emotion and speaker: the class tokens, as released and in
        appendix B.1, or the latents of emotion and style, as in section 3.2 and appendix B.4. With
        tokens, only the reconstruction constrains the latents.
    mfcc : int
        Number of cepstral coefficients of the auto-encoder that replaces the three encoders
        (Table A.3); 0 for the speech model itself.
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
    classified: Literal["tokens", "latent"] = "tokens"
    mfcc: int = 0


@dataclass(frozen=True, kw_only=True)
class MotionPreset(Preset):
    """Sizes and training of prior and denoiser.

    Attributes
    ----------
    network : MotionConfig
        Their sizes; conditions are as wide as the speech model's latents.
    stride : int
        Frames from one window to the next.
    together : int or None
        Number of steps in which prior and denoiser learn together, as in the paper; None for all.
        Afterwards the denoiser learns alone: its steps cost a tenth, and its latents stay fixed.
    weights : mapping of str to float
        Weights of losses that differ from `generators.amuse.losses.MOTION_LOSSES`.
    align_steps : int
        Number of DDIM steps in the third pass.
    named : float
        Probability with which the mean latent of its label, as in edits by name, replaces the
        speech's emotion, and likewise its style.
    """

    network: MotionConfig
    stride: int
    together: int | None = None
    weights: Mapping[str, float] = field(default_factory=dict)
    align_steps: int = 50
    named: float = 0.0


MOTION_PRESETS: Final = read_presets(Path(__file__).with_name("motion.toml"), MotionPreset)


@dataclass(frozen=True, kw_only=True)
class SpeechPreset(Preset):
    """Sizes and training of the speech model.

    Attributes
    ----------
    network : SpeechConfig
        Its sizes; emotions and styles are those of the recordings.
    seconds, stride : int
        Length of a window, and distance from one training window to the next.
    """

    network: SpeechConfig
    seconds: int
    stride: int


SPEECH_PRESETS: Final = read_presets(Path(__file__).with_name("speech.toml"), SpeechPreset)
