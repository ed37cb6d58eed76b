"""An audio spectrogram transformer (AST): its initial weights and the augmentation of its input.

Its first weights are those of another AST, or of a DeiT for images, of which Gong et al. 2021
(section 2.2) make an AST. Or it starts from the principal components of its patches, scaled to
equal size, so that pitch counts as well as loudness; and from waves that encode a patch's time and
pitch, which the mean over patches would otherwise lose. Filterbanks that it learns from are masked,
shifted and noisy.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Final

import torch
from torch import Tensor
from torch.nn import functional
from transformers import ASTConfig, ASTModel

from motion.errors import listed
from training.layers.first_weights import encode_components, principal_components, waves
from training.released_weights import CONFIG, SavedNetworks

_AST: Final = "audio-spectrogram-transformer"
_SAVED: Final = SavedNetworks(
    owner="the encoders",
    types={_AST: "an AST", "deit": "a DeiT"},
    # A layer behind the last one of a DeiT, which no encoder has.
    optional=("pooler.",),
    remedy="Give the folder that transformers' save_pretrained wrote of an AST or a distilled DeiT "
    "of the encoders' size, with config.json and model.safetensors; or another --config",
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
"""For the class and for distillation, before the patches."""

_COMPONENTS: Final = 64
"""Principal components of a patch that an encoder uses at first; smaller ones are noise."""

_INITIAL_SCALE: Final = 0.5
"""Of a patch's components, and of the waves that encode its position."""


def read_ast_weights(folder: Path, config: ASTConfig) -> dict[str, Tensor]:
    """Return the weights of such a transformer by name.

    Parameters
    ----------
    folder : Path
        What ``save_pretrained`` wrote of an AST or of a DeiT. Nothing but safetensors is read, and
        nothing is fetched.
    config : ASTConfig
        Its sizes.

    Raises
    ------
    InputError
        If the folder holds no such network, one of another size, or one that lacks weights.
    """
    network = _SAVED.load(folder)
    is_audio = network.config.model_type == _AST
    differences = [
        f"{name} {getattr(network.config, name)} in place of {getattr(config, name)}"
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
    """Return a DeiT's weights for filterbanks: colours summed, places of patches fitted.

    The middle of the grid of positions is used, and stretched where it is too small.
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
        Fresh.
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
"""Largest size of noise."""

_SHIFT: Final = 10
"""Rows by which a filterbank is shifted, at most."""


def augment(filterbanks: Tensor) -> tuple[Tensor, Tensor]:
    """Return input and target for filterbanks (n, frames, bands).

    Both are masked alike, up to the shares of the paper; the input is also shifted in time by up to
    ten rows, with noise. Chance is torch's.
    """
    count, frames, bands = filterbanks.shape
    rows = _random_run(count, frames, MASKED_ROWS)[:, :, None]
    columns = _random_run(count, bands, MASKED_BANDS)[:, None, :]
    masked = filterbanks.masked_fill((rows | columns).to(filterbanks.device), 0.0)
    shift = int(torch.randint(-_SHIFT, _SHIFT + 1, ()))
    noise = _NOISE * torch.rand(count, 1, 1) * torch.rand(filterbanks.shape)
    return torch.roll(masked + noise.to(filterbanks.device), shift, dims=1), masked


def _random_run(count: int, size: int, share: float) -> Tensor:
    """Return for each of `count` a run of places, at most a share of them, (count, size)."""
    width = torch.randint(0, max(1, round(share * size)) + 1, (count, 1))
    first = (torch.rand(count, 1) * (size - width + 1)).long()
    places = torch.arange(size)
    return (places >= first) & (places < first + width)
