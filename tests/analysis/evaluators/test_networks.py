from __future__ import annotations

import pytest
import torch

from analysis.evaluators.networks import AutoencoderConfig, AutoencoderNetwork


@pytest.mark.parametrize("window", [12, 13, 34, 60])
def test_windows_of_any_length_are_reconstructed_in_their_shape(window: int) -> None:
    network = AutoencoderNetwork(AutoencoderConfig(window=window, features=4), 7)
    windows = torch.randn(3, window, 7)
    assert network.embed(windows).shape == (3, 4)
    assert network(windows).shape == windows.shape


def test_the_autoencoder_loss_covers_values_and_their_differences() -> None:
    network = AutoencoderNetwork(AutoencoderConfig(window=12, features=4), 7).eval()
    windows = torch.randn(3, 12, 7)
    losses = network.losses(windows, torch.zeros(3))
    off = network(windows) - windows
    torch.testing.assert_close(losses["error"], off.abs().mean())
    torch.testing.assert_close(losses["change"], (off[:, 1:] - off[:, :-1]).abs().mean())
    torch.testing.assert_close(losses["loss"], losses["error"] + losses["change"])


def test_unseen_windows_are_reconstructed_better_than_by_the_mean() -> None:
    torch.manual_seed(0)
    network = AutoencoderNetwork(AutoencoderConfig(window=12, features=8), 4)
    phases, sizes = 6 * torch.rand(600, 1, 1), 0.5 + 1.5 * torch.rand(600, 1, 1)
    windows = sizes * torch.sin(0.5 * torch.arange(12)[:, None] + phases + torch.arange(4))
    optimizer = torch.optim.Adam(network.parameters(), lr=0.01)
    for _ in range(150):
        batch = windows[torch.randint(500, (32,))]
        optimizer.zero_grad()
        network.losses(batch, batch)["loss"].backward()  # type: ignore[no-untyped-call]
        optimizer.step()
    with torch.no_grad():
        measured = network.eval().measured(windows[500:], windows[500:])
    assert measured["error"] < 0.5 * measured["error_of_mean"]
