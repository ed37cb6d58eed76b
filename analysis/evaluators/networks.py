"""The networks that are trained here: an emotion classifier and a motion autoencoder.

The classifier is AMUSE's evaluator M (Chhatre et al. 2024, "Emotional Speech-driven 3D Body
Animation via Disentangled Latent Diffusion", section 5.1 and appendix D, after Petrovich et al.
2021). The paper appends a class token; the released network averages over frames instead, and so
does this one.

The autoencoder of short windows (convolutions over time, then one vector) follows the feature
network of Yoon et al. 2020, "Speech Gesture Generation from the Trimodal Context of Text, Audio,
and Speaker Identity", which BEAT (Liu et al. 2022) and DiffSHEG (Chen et al. 2024) use with more
features. Speech2UnifiedExpressions trains one on face landmarks for its FLD without stating its
layers; here it has Yoon's.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

from torch import Tensor, nn

from training.layers.transformers import sinusoids


@dataclass(frozen=True, kw_only=True)
class WindowConfig:
    """The windows in which a network sees motion.

    Attributes
    ----------
    frame_rate : float
        Frames per second to which clips are resampled.
    window : int
        Frames of a window.
    stride : int
        Frames from one window of a training clip to the next. Windows that are embedded for
        scores do not overlap.
    """

    frame_rate: float
    window: int
    stride: int


@dataclass(frozen=True, kw_only=True)
class EmotionConfig(WindowConfig):
    """Sizes of an emotion classifier.

    Attributes
    ----------
    width : int
        Length of an embedding; a multiple of twice `heads`.
    feed_forward : int
        Hidden units of each layer.
    layers, heads : int
        Layers and heads of the transformer.
    dropout : float
        In [0, 1).
    hidden : tuple of int
        Layers between embedding and emotions.
    """

    width: int
    feed_forward: int
    layers: int
    heads: int
    dropout: float
    hidden: tuple[int, ...]


@dataclass(frozen=True, kw_only=True)
class AutoencoderConfig(WindowConfig):
    """Sizes of an autoencoder, whose windows have at least 12 frames.

    Attributes
    ----------
    features : int
        Length of an embedding; the convolutions have as many channels, or twice as many.
    """

    features: int


class EmotionNetwork(nn.Module):
    """Embeds windows of motion and classifies their emotion.

    Parameters
    ----------
    config : EmotionConfig
        Sizes.
    channels : int
        Channels of a frame.
    emotions : int
        Number of emotions.
    """

    positions: Tensor

    def __init__(self, config: EmotionConfig, channels: int, emotions: int) -> None:
        super().__init__()
        self.entry = nn.Linear(channels, config.width)
        self.register_buffer("positions", sinusoids(config.window, config.width), persistent=False)
        self.dropout = nn.Dropout(config.dropout)
        layer = nn.TransformerEncoderLayer(
            config.width,
            config.heads,
            config.feed_forward,
            config.dropout,
            activation="gelu",
            batch_first=True,
        )
        self.encoder = nn.TransformerEncoder(layer, config.layers, enable_nested_tensor=False)
        sizes = (config.width, *config.hidden)
        parts: list[nn.Module] = []
        for size, following in pairwise(sizes):
            parts += [nn.Linear(size, following), nn.ReLU(), nn.Dropout(config.dropout)]
        self.classifier = nn.Sequential(*parts, nn.Linear(sizes[-1], emotions))

    def embed(self, windows: Tensor) -> Tensor:
        """Return the mean over frames of the last layer, shape (n, width)."""
        frames = self.dropout(self.entry(windows) + self.positions)
        embedded: Tensor = self.encoder(frames).mean(dim=1)
        return embedded

    def forward(self, windows: Tensor) -> Tensor:
        """Return the logits of the emotions, shape (n, emotions), of windows (n, T, channels)."""
        logits: Tensor = self.classifier(self.embed(windows))
        return logits

    def losses(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the cross-entropy of a batch, as in AMUSE's appendix D, and the accuracy."""
        logits = self(windows)
        return {
            "loss": nn.functional.cross_entropy(logits, labels),
            "accuracy": (logits.argmax(dim=1) == labels).double().mean(),
        }


_SLOPE: Final = 0.2
"""Negative slope of the leaky rectifiers."""


class AutoencoderNetwork(nn.Module):
    """Encodes windows as vectors, and decodes vectors to windows.

    Parameters
    ----------
    config : AutoencoderConfig
        Sizes.
    channels : int
        Channels of a frame.
    """

    def __init__(self, config: AutoencoderConfig, channels: int) -> None:
        super().__init__()
        size = config.features
        frames = (config.window - 8) // 2 - 1  # after four convolutions: 12 of 34
        self.encoder = nn.Sequential(
            *_convolved(channels, size),
            *_convolved(size, 2 * size),
            *_convolved(2 * size, 2 * size, kernel=4, stride=2),
            nn.Conv1d(2 * size, size, 3),
            nn.Flatten(),
            *_connected(frames * size, 4 * size),
            *_connected(4 * size, 2 * size),
            nn.Linear(2 * size, size),
        )
        self.decoder = nn.Sequential(
            *_connected(size, 2 * size),
            nn.Linear(2 * size, config.window * size),
            nn.Unflatten(1, (size, config.window)),
            *_convolved(size, 2 * size, padding=1),
            *_convolved(2 * size, 2 * size, padding=1),
            nn.Conv1d(2 * size, channels, 3, padding=1),
        )

    def embed(self, windows: Tensor) -> Tensor:
        """Return the vectors, shape (n, features), of windows (n, T, channels)."""
        embedded: Tensor = self.encoder(windows.transpose(1, 2))
        return embedded

    def forward(self, windows: Tensor) -> Tensor:
        """Return the reconstructed windows, shape (n, T, channels)."""
        rebuilt: Tensor = self.decoder(self.embed(windows))
        return rebuilt.transpose(1, 2)

    def losses(self, windows: Tensor, labels: Tensor) -> Mapping[str, Tensor]:
        """Return the errors of a batch, in deviations of the training frames.

        The loss is the mean absolute error of values and of their changes from frame to frame (Yoon
        et al. 2020). ``error_of_mean`` is the error of the mean pose.
        """
        rebuilt = self(windows)
        error = nn.functional.l1_loss(rebuilt, windows)
        change = nn.functional.l1_loss(rebuilt.diff(dim=1), windows.diff(dim=1))
        return {
            "loss": error + change,
            "error": error,
            "change": change,
            "error_of_mean": windows.abs().mean(),
        }


def _convolved(
    channels: int, size: int, *, kernel: int = 3, stride: int = 1, padding: int = 0
) -> tuple[nn.Module, ...]:
    # Batch normalisation cancels a bias, which would only drift by rounding.
    convolution = nn.Conv1d(channels, size, kernel, stride=stride, padding=padding, bias=False)
    return convolution, nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE)


def _connected(entries: int, size: int) -> tuple[nn.Module, ...]:
    return nn.Linear(entries, size, bias=False), nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE)
