"""An audio spectrogram transformer (AST): its initial weights and the augmentation of its input.

It starts from the weights of another AST, or of a DeiT for images, adapted as by Gong et al. 2021
(section 2.2). Or it starts from the principal components of its patches, scaled to equal size, so
that pitch counts as much as loudness; and from waves that encode a patch's time and pitch, which
the mean over patches would otherwise lose. Filterbanks for training are masked, shifted and noisy.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Final

import torch
from torch import Tensor
from torch.nn import functional

from motion.errors import listed
from training.layers.first_weights import encode_components, principal_components, waves
from training.released_weights import CONFIG, SavedNetworks

if TYPE_CHECKING:
    from transformers import ASTConfig, ASTModel

_AST: Final = "audio-spectrogram-transformer"
_SAVED: Final = SavedNetworks(
    owner="the encoders",
    types={_AST: "an AST", "deit": "a DeiT"},
    # A layer after the last one of a DeiT, which the encoders do not have.
    optional=("pooler.",),
    remedy="Give a folder of transformers' save_pretrained, with config.json and "
    "model.safetensors, of an AST or a distilled DeiT of the encoders' size; or another --config",
)
_SIZES: Final = (
    "hidden_size",
    "num_hidden_layers",
    "num_attention_heads",
    "intermediate_size",
    "patch_size",
)
_AUDIO_SIZES: Final = ("max_length", "num_mel_bins", "time_stride", "frequency_stride")
_TOKENS: Final = 2
"""Number of tokens before the patches: for the class and for distillation."""

_COMPONENTS: Final = 64
"""Number of principal components of a patch that an encoder starts from; others are noise."""

_INITIAL_SCALE: Final = 0.5
"""Scale of a patch's components, and of the waves that encode its position."""


def read_ast_weights(folder: Path, config: ASTConfig) -> dict[str, Tensor]:
    """Return the weights of an AST by name.

    Parameters
    ----------
    folder : Path
        A folder of ``save_pretrained`` of an AST or a DeiT. Only safetensors are read, and nothing
        is downloaded.
    config : ASTConfig
        The expected sizes.

    Raises
    ------
    InputError
        If the folder has no such network, or one of another size or with missing weights.
    """
    network = _SAVED.load(folder)
    is_audio = network.config.model_type == _AST
    differences = [
        f"{name} {getattr(network.config, name)} instead of {getattr(config, name)}"
        for name in (*_SIZES, *(_AUDIO_SIZES if is_audio else ()))
        if getattr(network.config, name) != getattr(config, name)
    ]
    if differences:
        raise _SAVED.error(
            f"the network has another size than the encoders: {listed(differences)}",
            folder / CONFIG,
        )
    weights = {
        name: tensor.float()
        for name, tensor in network.state_dict().items()
        if not name.startswith("pooler.")
    }
    return weights if is_audio else _adapt_image_weights(weights, config)


def _adapt_image_weights(weights: dict[str, Tensor], config: ASTConfig) -> dict[str, Tensor]:
    """Return a DeiT's weights for filterbanks: colours summed, positions of patches fitted.

    The middle of the grid of positions is used, and stretched if it is too small.
    """
    patches = "embeddings.patch_embeddings.projection.weight"
    places = "embeddings.position_embeddings"
    tokens, grid = weights[places][:, :_TOKENS], weights[places][:, _TOKENS:]
    side, patch = round(grid.shape[1] ** 0.5), weights[patches].shape[2]
    rows, columns = (
        (length - patch) // stride + 1
        for length, stride in (
            (config.num_mel_bins, config.frequency_stride),
            (config.max_length, config.time_stride),
        )
    )
    top, left = (max(0, (side - count) // 2) for count in (rows, columns))
    middle = grid.transpose(1, 2).reshape(1, -1, side, side)[
        :, :, top : top + rows, left : left + columns
    ]
    fitted = functional.interpolate(middle, size=(rows, columns), mode="bilinear")
    return weights | {
        patches: weights[patches].sum(dim=1, keepdim=True),
        places: torch.cat([tokens, fitted.flatten(2).transpose(1, 2)], dim=1),
    }


@torch.no_grad()
def initialise_from_speech(network: ASTModel, filterbanks: Tensor) -> None:
    """Initialise the input layers of a new network; its positions encode patches' time and pitch.

    Parameters
    ----------
    network : ASTModel
        A new network.
    filterbanks : Tensor
        (windows, frames, bands), examples of its input.
    """
    embeddings = network.embeddings
    first, positions = embeddings.patch_embeddings.projection, embeddings.position_embeddings
    size = first.kernel_size[0]
    patches = filterbanks.unfold(1, size, size).unfold(2, size, size).transpose(3, 4)
    components = principal_components(
        patches.reshape(-1, size**2), min(_COMPONENTS, len(first.weight))
    )
    encode_components(first, components, _INITIAL_SCALE)
    bands, rows = embeddings.get_shape(embeddings.config)
    half = positions.shape[-1] // 2
    pitch, time = (
        waves(torch.arange(count), math.pi / count, math.pi, half) for count in (bands, rows)
    )
    places = [time.expand(bands, -1, -1), pitch[:, None].expand(-1, rows, -1)]
    positions[0, -bands * rows :] = _INITIAL_SCALE * torch.cat(places, dim=-1).flatten(0, 1)


MASKED_BANDS: Final = 24 / 128
MASKED_ROWS: Final = 96 / 1024
"""Largest shares of bands and of rows that are masked (Park et al. 2019)."""

_NOISE: Final = 0.1
"""Largest amplitude of noise."""

_SHIFT: Final = 10
"""Largest shift of a filterbank, in rows."""


def augment(filterbanks: Tensor) -> tuple[Tensor, Tensor]:
    """Return input and target for filterbanks (n, frames, bands).

    Both have the same mask, up to the shares of the paper. The input is also noisy and shifted in
    time by up to ten rows. Randomness is torch's.
    """
    count, frames, bands = filterbanks.shape
    rows = _random_run(count, frames, MASKED_ROWS)[:, :, None]
    columns = _random_run(count, bands, MASKED_BANDS)[:, None, :]
    masked = filterbanks.masked_fill((rows | columns).to(filterbanks.device), 0.0)
    shift = int(torch.randint(-_SHIFT, _SHIFT + 1, ()))
    noise = _NOISE * torch.rand(count, 1, 1) * torch.rand(filterbanks.shape)
    return torch.roll(masked + noise.to(filterbanks.device), shift, dims=1), masked


def _random_run(count: int, size: int, share: float) -> Tensor:
    """Return `count` masks (count, size), each of one run of at most `share` of the places."""
    width = torch.randint(0, max(1, round(share * size)) + 1, (count, 1))
    first = (torch.rand(count, 1) * (size - width + 1)).long()
    places = torch.arange(size)
    return (places >= first) & (places < first + width)
