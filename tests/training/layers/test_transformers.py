"""Packed networks compute what they did before."""

from __future__ import annotations

import torch
from transformers import ASTConfig, ASTModel

from training.layers.transformers import PackedLinear, pack


def test_a_packed_transformer_hears_the_same() -> None:
    config = ASTConfig(
        hidden_size=32,
        num_hidden_layers=2,
        num_attention_heads=4,
        intermediate_size=48,
        max_length=64,
        num_mel_bins=32,
    )
    torch.manual_seed(2)
    model = ASTModel(config).eval().requires_grad_(False)
    heard = torch.randn(3, 64, 32)
    with torch.inference_mode():
        before = model(heard).last_hidden_state
        pack(model)
        after = model(heard).last_hidden_state
    assert torch.allclose(before, after, atol=1e-5)
    assert any(isinstance(one, PackedLinear) for one in model.modules())
