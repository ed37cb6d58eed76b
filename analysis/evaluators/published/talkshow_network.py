"""TalkSHOW's evaluator (Yi et al. 2023): the encoder of its body autoencoder."""

from __future__ import annotations

from typing import Final

from torch import Tensor, nn

CHANNELS: Final = 129
"""Numbers of a frame: axis-angles of 43 joints."""

FEATURES: Final = 64

SHRINKS: Final = 4
"""Frames of motion to one row of features."""

_WIDTHS: Final = (256, 512, 1024)
_SLOPE: Final = 0.2


class TalkShowNetwork(nn.Module):
    """Turns motion, shape (n, T, 129), into features, shape (n, T / 4, 64)."""

    def __init__(self) -> None:
        super().__init__()
        first, second, third = _WIDTHS
        self.encoder = nn.Sequential()
        for name, part in (
            ("project", _Convolved(CHANNELS, first)),
            ("_enc_1", _Stack(first)),
            ("_down_1", _Halved(first, second)),
            ("_enc_2", _Stack(second)),
            ("_down_2", _Halved(second, third)),
            ("_enc_3", _Stack(third)),
            ("pre_vq_conv", nn.Conv1d(third, FEATURES, 1)),
        ):
            self.encoder.add_module(name, part)

    def forward(self, motion: Tensor) -> Tensor:
        """Return the features."""
        found: Tensor = self.encoder(motion.transpose(1, 2))
        return found.transpose(1, 2)


class _Convolved(nn.Module):
    def __init__(self, entries: int, size: int, kernel: int = 3, stride: int = 1) -> None:
        super().__init__()
        self.conv = nn.Conv1d(entries, size, kernel, stride=stride, padding=1)
        self.norm = nn.BatchNorm1d(size)

    def normed(self, values: Tensor) -> Tensor:
        found: Tensor = self.norm(self.conv(values))
        return found

    def forward(self, values: Tensor) -> Tensor:
        return nn.functional.leaky_relu(self.normed(values), _SLOPE)


class _Halved(_Convolved):
    """Halves the frames, with a second convolution beside the normed one."""

    def __init__(self, entries: int, size: int) -> None:
        super().__init__(entries, size, kernel=4, stride=2)
        self.residual_layer = nn.Conv1d(entries, size, 4, stride=2, padding=1)

    def forward(self, values: Tensor) -> Tensor:
        together = self.normed(values) + self.residual_layer(values)
        return nn.functional.leaky_relu(together, _SLOPE)


class _Stack(_Convolved):
    """Two convolutions and a third, whose result is added to what came in."""

    def __init__(self, size: int) -> None:
        super().__init__(size, size)
        self._layers = nn.ModuleList([_Convolved(size, size), _Convolved(size, size)])

    def forward(self, values: Tensor) -> Tensor:
        found = values
        for layer in self._layers:
            found = layer(found)
        return nn.functional.relu(self.normed(found) + values)
