"""Positions, transformers with skips, and transformers packed for inference on a CPU.

Skips are those of Bao et al. 2023 (U-ViT) and Chen et al. 2023 (MLD). Packed layers are faster and
give the same results up to rounding. torch multiplies matrices with MKL, which is slow on CPUs that
are not Intel's. oneDNN, a part of torch, is fast on all of them, and lays out weights only once.
"""

import math
from typing import Any, Final

import torch
from torch import Tensor, nn


def sinusoids(length: int, width: int) -> Tensor:
    """Return positional encodings (Vaswani et al. 2017, section 3.5), shape (length, width)."""
    exponents = torch.arange(0, width, 2, dtype=torch.float32) / width
    angles = torch.arange(length)[:, None] * torch.exp(-math.log(10_000) * exponents)
    return torch.stack([angles.sin(), angles.cos()], dim=-1).reshape(length, width)


class SkipTransformer(nn.Module):
    """Transformer layers with skips from the first half to the second, as in a U-Net.

    Parameters
    ----------
    width, feed_forward, heads, layers : int
        Sizes of the layers and their number, which is odd.
    dropout : float
        Dropout in training.
    reads_memory : bool
        Whether each layer also attends to a memory.
    """

    def __init__(
        self,
        width: int,
        feed_forward: int,
        heads: int,
        layers: int,
        *,
        dropout: float,
        reads_memory: bool = False,
    ) -> None:
        super().__init__()
        kind = nn.TransformerDecoderLayer if reads_memory else nn.TransformerEncoderLayer

        def blocks(count: int) -> nn.ModuleList:
            sizes = (width, heads, feed_forward, dropout)
            return nn.ModuleList(
                kind(*sizes, activation="gelu", batch_first=True) for _ in range(count)
            )

        half = layers // 2
        self.input_blocks = blocks(half)
        self.middle_block = blocks(1)[0]
        self.output_blocks = blocks(half)
        self.linear_blocks = nn.ModuleList(nn.Linear(2 * width, width) for _ in range(half))
        self.norm = nn.LayerNorm(width)

    def forward(self, x: Tensor, *memory: Tensor) -> Tensor:
        """Transform the sequence `x` (batch, tokens, width)."""
        skips = []
        for block in self.input_blocks:
            x = block(x, *memory)
            skips.append(x)
        x = self.middle_block(x, *memory)
        for linear, block in zip(self.linear_blocks, self.output_blocks, strict=True):
            x = block(linear(torch.cat([x, skips.pop()], dim=-1)), *memory)
        normalised: Tensor = self.norm(x)
        return normalised


_ROWS: Final = 1_214
"""Number of rows that the layout is chosen for: AST's tokens of ten seconds."""

_ATTENTION: Final = "motionjury_packed"


class PackedLinear(nn.Module):
    """A float32 linear layer for inference on the CPU; its weights are not saved."""

    def __init__(self, linear: nn.Linear) -> None:
        super().__init__()
        self.bias = linear.bias
        weight = linear.weight.detach()
        self._packed: Tensor = torch.ops.mkldnn._reorder_linear_weight(weight, _ROWS)

    def forward(self, x: Tensor) -> Tensor:
        """Return the layer's output for `x` (…, in)."""
        return _product(x, self._packed, self.bias)


def pack(network: nn.Module) -> None:
    """Pack the linear layers and attention of a network's `transformers` models.

    Does nothing on a GPU or without oneDNN.
    """
    if not torch.backends.mkldnn.is_available():  # type: ignore[no-untyped-call]
        return
    # Imported here: it takes seconds, and networks without such a model need none of it.
    from transformers import PreTrainedModel
    from transformers.modeling_utils import ALL_ATTENTION_FUNCTIONS

    ALL_ATTENTION_FUNCTIONS.register(_ATTENTION, _attention)
    for model in network.modules():
        if isinstance(model, PreTrainedModel) and model.device.type == "cpu":
            model.config._attn_implementation = _ATTENTION
            _pack_layers(model)


def _pack_layers(network: nn.Module) -> None:
    for name, child in network.named_children():
        if isinstance(child, nn.Linear):
            setattr(network, name, PackedLinear(child))
        else:
            _pack_layers(child)


def _attention(
    module: nn.Module,
    query: Tensor,
    key: Tensor,
    value: Tensor,
    attention_mask: Tensor | None,
    scaling: float,
    **unused: Any,
) -> tuple[Tensor, None]:
    """Compute attention of (batch, heads, tokens, width) with the interface of `transformers`."""
    if attention_mask is not None:
        raise NotImplementedError("packed attention does not support masks")
    q, k, v = (tensor.contiguous().flatten(0, 1) for tensor in (query * scaling, key, value))
    heads = [
        _product(torch.softmax(_product(a, b), dim=-1), c.T.contiguous())
        for a, b, c in zip(q, k, v, strict=True)
    ]
    return torch.stack(heads).view(query.shape).transpose(1, 2), None


def _product(x: Tensor, weight: Tensor, bias: Tensor | None = None) -> Tensor:
    product: Tensor = torch.ops.mkldnn._linear_pointwise(x, weight, bias, "none", [], "")
    return product
