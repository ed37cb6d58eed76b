from __future__ import annotations

import math
from collections.abc import Callable

import pytest
import torch
from torch import nn

from analysis.evaluators.networks import (
    EMOTION_FULL,
    EMOTION_TINY,
    AutoencoderConfig,
    AutoencoderNetwork,
    EmotionConfig,
    EmotionNetwork,
    sinusoids,
)
from motion.errors import InputError


def test_the_full_emotion_network_has_the_sizes_that_amuse_states() -> None:
    with torch.device("meta"):
        network = EmotionNetwork(EMOTION_FULL, 47 * 6, 8)
    assert (len(network.encoder.layers), network.entry.out_features) == (8, 256)
    assert network.encoder.layers[0].self_attn.num_heads == 4
    assert network.encoder.layers[0].linear1.out_features == 1024
    connected = [part for part in network.classifier if isinstance(part, nn.Linear)]
    assert [(part.in_features, part.out_features) for part in connected] == [
        (256, 128),
        (128, 64),
        (64, 8),
    ]
    assert EMOTION_FULL.seconds == 10


def test_an_embedding_of_the_emotion_network_is_the_mean_over_its_frames() -> None:
    torch.manual_seed(0)
    network = EmotionNetwork(EMOTION_TINY, 12, 3).eval()
    windows = torch.randn(2, 60, 12)
    frames = network.encoder(network.entry(windows) + network.positions)
    torch.testing.assert_close(network.embed(windows), frames.mean(dim=1))
    torch.testing.assert_close(network(windows), network.classifier(frames.mean(dim=1)))


def test_the_order_of_frames_matters_to_the_emotion_network() -> None:
    torch.manual_seed(0)
    network = EmotionNetwork(EMOTION_TINY, 12, 3).eval()
    windows = torch.randn(1, 60, 12)
    assert not torch.allclose(network.embed(windows), network.embed(windows.flip(1)), atol=1e-4)


def test_positions_are_sines_and_cosines() -> None:
    table = sinusoids(5, 4)
    torch.testing.assert_close(table[0], torch.tensor([0.0, 1.0, 0.0, 1.0]))
    torch.testing.assert_close(table[3, :2], torch.tensor([math.sin(3), math.cos(3)]))


@pytest.mark.parametrize("window", [12, 13, 34, 60])
def test_windows_of_any_length_are_rebuilt_in_their_shape(window: int) -> None:
    network = AutoencoderNetwork(AutoencoderConfig(window=window, features=4), 7)
    windows = torch.randn(3, window, 7)
    assert network.embed(windows).shape == (3, 4)
    assert network(windows).shape == windows.shape


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: AutoencoderConfig(window=11), "window of the network is 11"),
        (lambda: AutoencoderConfig(features=0), "features"),
        (lambda: AutoencoderConfig(stride=0), "stride"),
        (lambda: AutoencoderConfig(frame_rate=0), "frame rate 0"),
        (lambda: EmotionConfig(width=60, heads=8), "multiple of twice the heads"),
        (lambda: EmotionConfig(dropout=1.0), "dropout"),
        (lambda: EmotionConfig(hidden=(0,)), "hidden"),
        (lambda: EmotionConfig(layers=0), "layers"),
    ],
)
def test_sizes_out_of_range_are_named(make: Callable[[], object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make()
