"""A block with the modulations of every diffusion step worked into its norms."""

from __future__ import annotations

from torch import Tensor
from torch.nn import functional

from generators.diffsheg.layers import LinearAttention, StyledBlock, Stylization
from generators.diffsheg.prepared_linear import PreparedLinear


class PreparedStyle:
    """A stylisation for the steps of a walk and one speaker.

    Scaling and shifting what a norm has scaled and shifted is one norm with other weights.

    Parameters
    ----------
    plain : Stylization
        The plain one.
    modulations : Tensor
        (places, 1, 2 · width); see `Stylization.modulate`.
    """

    def __init__(self, plain: Stylization, modulations: Tensor) -> None:
        scale, shift = modulations[:, 0].chunk(2, dim=-1)
        self._scales = plain.norm.weight * (1 + scale)
        self._shifts = plain.norm.bias * (1 + scale) + shift
        self._epsilon = plain.norm.eps
        self._out = PreparedLinear(plain.out.weight, plain.out.bias)

    def styled(self, features: Tensor, place: int) -> Tensor:
        """Return (batch, frames, width)."""
        normed = functional.layer_norm(
            features,
            features.shape[-1:],
            self._scales[place],
            self._shifts[place],
            self._epsilon,
        )
        return self._out.mapped(functional.silu(normed, inplace=True))


class PreparedAttention:
    """Linear attention with prepared maps."""

    def __init__(self, plain: LinearAttention) -> None:
        self._query, self._key, self._value = (
            PreparedLinear(one.weight, one.bias) for one in (plain.query, plain.key, plain.value)
        )
        self._norm = plain.norm
        self._heads = plain.heads

    def attended(self, features: Tensor) -> Tensor:
        """Return (batch, frames, width)."""
        normed = self._norm(features)
        split = (*features.shape[:2], self._heads, -1)
        query = self._query.mapped(normed).view(split).softmax(dim=-1)
        key = self._key.mapped(normed).view(split).softmax(dim=1)
        value = self._value.mapped(normed).view(split)
        context = key.permute(0, 2, 3, 1) @ value.transpose(1, 2)
        attended = query.transpose(1, 2) @ context
        return attended.transpose(1, 2).reshape(features.shape)


class PreparedBlock:
    """The style-aware block for the steps of a walk and one speaker.

    Parameters
    ----------
    plain : StyledBlock
        The plain one.
    modulations : Tensor
        (places, 1, 4 · width); see `StyledBlock.modulate`.
    """

    def __init__(self, plain: StyledBlock, modulations: Tensor) -> None:
        first, second = modulations.chunk(2, dim=-1)
        self._attention = PreparedAttention(plain.attention)
        self._attention_style = PreparedStyle(plain.attention.stylization, first)
        feed_forward = plain.feed_forward
        self._widen = PreparedLinear(feed_forward.widen.weight, feed_forward.widen.bias)
        self._narrow = PreparedLinear(feed_forward.narrow.weight, feed_forward.narrow.bias)
        self._style = PreparedStyle(feed_forward.stylization, second)

    def change(self, features: Tensor, place: int) -> None:
        """Put what the block makes of `features`, (batch, frames, width), in their place."""
        features += self._attention_style.styled(self._attention.attended(features), place)
        inner = self._narrow.mapped(functional.gelu(self._widen.mapped(features)))
        features += self._style.styled(inner, place)
