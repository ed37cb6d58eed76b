"""The published networks, with the published names of their weights, and loading checkpoints."""

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from torch import Tensor, nn

from motion.errors import InputError
from training.released_weights import fill, not_weights_error, read_saved

_SLOPE: Final = 0.2
"""Negative slope of the leaky rectifiers between convolutions."""

TRIMMED_TO: Final = 32
"""The published code drops trailing frames until their number is a multiple of this."""

_LAYERS: Final = ((330, 330, 210), (210, 210, 120), (120, 240, None), (240, 240, None))
"""Channels before and after each layer's convolution, and after its pooling where it pools."""

_GROUPS: Final = 10

_WIDTHS: Final = (256, 512, 1024)

_CONVOLVED_FRAMES: Final = 12
"""Frames of a window after the convolutions."""

_SLOPE_OF_TRUE: Final = 1.0
"""The same between full layers: published as ``LeakyReLU(True)``, whose slope is 1."""


class EmageNetwork(nn.Module):
    """EMAGE's evaluator, also that of the GENEA leaderboard: motion to features.

    The encoder of VAESKConv (Liu et al. 2024, "EMAGE"), after Aberman et al. 2020, "Skeleton-Aware
    Networks for Deep Motion Retargeting": convolutions over a skeleton's edges turn motion, shape
    (n, T, 330), into features, shape (n, T / 16, 240). Which edges a convolution joins (its mask)
    and how edges are pooled are arrays of the published file, so that no skeleton is needed here.
    """

    def __init__(self) -> None:
        super().__init__()
        layers = (nn.Sequential(_SkeletonResidual(*sizes)) for sizes in _LAYERS)
        self.encoder = nn.ModuleDict({"layers": nn.ModuleList(layers)})

    def forward(self, motion: Tensor) -> Tensor:
        """Return the features; trailing frames past a multiple of 32 are left out."""
        values = motion[:, : motion.shape[1] // TRIMMED_TO * TRIMMED_TO].transpose(1, 2)
        for layer in self.encoder.get_submodule("layers").children():
            values = layer(values)
        return values.transpose(1, 2)


class _SkeletonResidual(nn.Module):
    """Halves the frames, then pools the edges."""

    def __init__(self, entries: int, size: int, pooled: int | None) -> None:
        super().__init__()
        self.residual = nn.Sequential(
            _SkeletonConvolution(entries, size, 4, padding=1), nn.GroupNorm(_GROUPS, size)
        )
        self.shortcut = _SkeletonConvolution(entries, size, 1, padding=0)
        pool = [] if pooled is None else [_SkeletonPool(size, pooled)]
        self.common = nn.Sequential(*pool, nn.Tanh())

    def forward(self, values: Tensor) -> Tensor:
        pooled: Tensor = self.common(self.residual(values) + self.shortcut(values))
        return pooled


class _SkeletonConvolution(nn.Module):
    """A convolution over time, of every second frame, with a mask over its weights."""

    def __init__(self, entries: int, size: int, kernel: int, *, padding: int) -> None:
        super().__init__()
        self.mask = nn.Parameter(torch.ones(size, entries, kernel), requires_grad=False)
        self.weight = nn.Parameter(torch.zeros(size, entries, kernel))
        self.bias = nn.Parameter(torch.zeros(size))
        self._padding = padding

    def forward(self, values: Tensor) -> Tensor:
        return nn.functional.conv1d(
            values, self.weight * self.mask, self.bias, stride=2, padding=self._padding
        )


class _SkeletonPool(nn.Module):
    """Mixes edges by a matrix."""

    def __init__(self, entries: int, size: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(size, entries), requires_grad=False)

    def forward(self, values: Tensor) -> Tensor:
        return torch.matmul(self.weight, values)


class TalkShowNetwork(nn.Module):
    """TalkSHOW's evaluator (Yi et al. 2023): the encoder of its body autoencoder.

    Turns motion, shape (n, T, 129), into features, shape (n, T / 4, 64).
    """

    def __init__(self) -> None:
        super().__init__()
        first, second, third = _WIDTHS
        self.encoder = nn.Sequential()
        for name, part in (
            ("project", _ShowConvolved(129, first)),
            ("_enc_1", _Stack(first)),
            ("_down_1", _Halved(first, second)),
            ("_enc_2", _Stack(second)),
            ("_down_2", _Halved(second, third)),
            ("_enc_3", _Stack(third)),
            ("pre_vq_conv", nn.Conv1d(third, 64, 1)),
        ):
            self.encoder.add_module(name, part)

    def forward(self, motion: Tensor) -> Tensor:
        """Return the features."""
        features: Tensor = self.encoder(motion.transpose(1, 2))
        return features.transpose(1, 2)


class _ShowConvolved(nn.Module):
    def __init__(self, entries: int, size: int, kernel: int = 3, stride: int = 1) -> None:
        super().__init__()
        self.conv = nn.Conv1d(entries, size, kernel, stride=stride, padding=1)
        self.norm = nn.BatchNorm1d(size)

    def normed(self, values: Tensor) -> Tensor:
        normed: Tensor = self.norm(self.conv(values))
        return normed

    def forward(self, values: Tensor) -> Tensor:
        return nn.functional.leaky_relu(self.normed(values), _SLOPE)


class _Halved(_ShowConvolved):
    """Halves the frames, with a second convolution parallel to the normed one."""

    def __init__(self, entries: int, size: int) -> None:
        super().__init__(entries, size, kernel=4, stride=2)
        self.residual_layer = nn.Conv1d(entries, size, 4, stride=2, padding=1)

    def forward(self, values: Tensor) -> Tensor:
        total = self.normed(values) + self.residual_layer(values)
        return nn.functional.leaky_relu(total, _SLOPE)


class _Stack(_ShowConvolved):
    """Three convolutions, whose result is added to the input."""

    def __init__(self, size: int) -> None:
        super().__init__(size, size)
        self._layers = nn.ModuleList([_ShowConvolved(size, size), _ShowConvolved(size, size)])

    def forward(self, values: Tensor) -> Tensor:
        hidden = values
        for layer in self._layers:
            hidden = layer(hidden)
        return nn.functional.relu(self.normed(hidden) + values)


class YoonNetwork(nn.Module):
    """Turns windows of motion, shape (n, 34, channels), into vectors, shape (n, features).

    The encoder of Yoon et al. 2020, "Speech Gesture Generation from the Trimodal Context of Text,
    Audio, and Speaker Identity", for TED Gesture, which BEAT (Liu et al. 2022) made larger.

    Parameters
    ----------
    channels : int
        Channels of a frame.
    convolved : tuple of int
        Channels after each of the four convolutions.
    connected : tuple of int
        Sizes of the full layers; the last is that of the features.
    """

    def __init__(
        self, channels: int, convolved: tuple[int, int, int, int], connected: tuple[int, int, int]
    ) -> None:
        super().__init__()
        first, second, third, last = convolved
        wide, narrow, features = connected
        self.pose_encoder = nn.ModuleDict(
            {
                "net": nn.Sequential(
                    _convolved(channels, first, 3, 1),
                    _convolved(first, second, 3, 1),
                    _convolved(second, third, 4, 2),
                    nn.Conv1d(third, last, 3),
                ),
                "out_net": nn.Sequential(
                    *_connected(last * _CONVOLVED_FRAMES, wide),
                    *_connected(wide, narrow),
                    nn.Linear(narrow, features),
                ),
                "fc_mu": nn.Linear(features, features),
            }
        )

    def forward(self, windows: Tensor) -> Tensor:
        """Return the mean of the latent distribution, which is the published feature."""
        encoder = self.pose_encoder
        convolved = encoder["net"](windows.transpose(1, 2))
        features: Tensor = encoder["fc_mu"](encoder["out_net"](convolved.flatten(1)))
        return features


def _convolved(entries: int, size: int, kernel: int, stride: int) -> nn.Sequential:
    convolution = nn.Conv1d(entries, size, kernel, stride=stride)
    return nn.Sequential(convolution, nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE))


def _connected(entries: int, size: int) -> tuple[nn.Module, ...]:
    return nn.Linear(entries, size), nn.BatchNorm1d(size), nn.LeakyReLU(_SLOPE_OF_TRUE)


def load_weights(network: nn.Module, file: Path, place: tuple[str, ...]) -> None:
    """Load the weights of a checkpoint into a network, and set it to evaluation.

    Parameters
    ----------
    network : Module
        Has the published names. Other parts of the file, such as a decoder, are ignored.
    file : Path
        Written by ``torch.save``. Only tensors, plain values and ``argparse.Namespace``, in which
        training scripts keep their options, are unpickled; this runs no code.
    place : tuple of str
        Keys under which the file holds the weights; it may also hold the weights alone.

    Raises
    ------
    InputError
        If the file is missing, or holds other objects or another network's weights.
    """
    try:
        with torch.serialization.safe_globals([argparse.Namespace]):
            content = read_saved(file)
    except InputError as error:
        raise InputError(error.what, where=file, remedy=_REMEDY) from error
    for key in place:
        if isinstance(content, Mapping) and isinstance(content.get(key), Mapping):
            content = content[key]
    if not isinstance(content, Mapping):
        raise not_weights_error(file, "it holds no named weights")
    parts = {name.partition(".")[0] for name in network.state_dict()}
    # A variational encoder has a second head, fc_logvar, which no feature uses.
    weights = {
        name: weight
        for name, weight in ((str(n).removeprefix("module."), w) for n, w in content.items())
        if isinstance(weight, Tensor)
        and name.partition(".")[0] in parts
        and ".fc_logvar." not in name
    }
    fill(
        network,
        weights,
        file,
        "the published network",
        f"Give the released checkpoint of this preset, with the weights under {'.'.join(place)!r}",
    )


_REMEDY: Final = (
    "Give the file as it was published. If it holds other objects and you trust it, save its "
    "weights alone, where its authors' code runs: "
    "checkpoint = torch.load(FILE, weights_only=False); checkpoint.pop('args', None); "
    "torch.save(checkpoint, NEW_FILE)"
)
