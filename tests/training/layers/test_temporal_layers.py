"""Layers over time keep the number of frames, and see no further than they reach."""

from __future__ import annotations

import pytest
import torch

from training.layers.temporal_layers import Decoder, over_time


@pytest.mark.parametrize(("kernel", "dilation"), [(3, 1), (5, 1), (3, 4)])
def test_a_convolution_reaches_half_its_kernel_to_both_sides(kernel: int, dilation: int) -> None:
    torch.manual_seed(1)
    layer = over_time(2, 3, kernel, dilation).eval()
    values = torch.randn(1, 2, 20)
    moved = values.clone()
    moved[..., 10] += 1
    changed = (layer(moved) - layer(values)).abs().amax(dim=(0, 1)) > 1e-6
    reach = kernel // 2 * dilation
    wanted = list(range(10 - reach, 10 + reach + 1, dilation))
    assert changed.nonzero().ravel().tolist() == wanted


def test_a_decoder_tells_every_frame() -> None:
    assert Decoder(6, 8, 27)(torch.randn(2, 11, 6)).shape == (2, 11, 27)
