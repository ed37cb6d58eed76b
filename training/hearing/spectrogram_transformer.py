"""An audio spectrogram transformer (AST): what it sets out from, and what it hears while learning.

Its first weights are those of another AST, or of a DeiT for images, of which Gong et al. 2021
(section 2.2) make an AST. Or it sets out from the principal components of the patches that it is to
hear, each as large as the next, so that the height of a voice counts beside its loudness; and from
waves that tell a patch's time and pitch, without which the mean over patches forgets both.
Filterbanks that it learns from are masked, shifted and noisy.
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
from training.layers.first_weights import components_of, tell_components, waves
from training.released_weights import CONFIG, SavedNetworks

_AST: Final = "audio-spectrogram-transformer"
_SAVED: Final = SavedNetworks(
    whose="the encoders",
    types={_AST: "an AST", "deit": "a DeiT"},
    # A layer behind the last one of a DeiT, which no encoder has.
    unasked=("pooler.",),
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
_OF_SOUND: Final = ("max_length", "num_mel_bins", "time_stride", "frequency_stride")
_TOKENS: Final = 2
"""For the class and for distillation, before the patches."""

_COMPONENTS: Final = 64
"""Principal components of a patch that an encoder hears at first; smaller ones are noise."""

_SIZE: Final = 0.5
"""Of a patch's components, and of the waves that tell its place."""


def read_ast_weights(folder: Path, wanted: ASTConfig) -> dict[str, Tensor]:
    """Return the weights of such a transformer by name.

    Parameters
    ----------
    folder : Path
        What ``save_pretrained`` wrote of an AST or of a DeiT. Nothing but safetensors is read, and
        nothing is fetched.
    wanted : ASTConfig
        Its sizes.

    Raises
    ------
    InputError
        If the folder holds no such network, one of another size, or one that lacks weights.
    """
    network = _SAVED.load(folder)
    of_sound = network.config.model_type == _AST
    other = [
        f"{name} {getattr(network.config, name)} in place of {getattr(wanted, name)}"
        for name in (*_SIZES, *(_OF_SOUND if of_sound else ()))
        if getattr(network.config, name) != getattr(wanted, name)
    ]
    if other:
        raise _SAVED.refused(
            f"the network has another size than the encoders: {listed(other)}", folder / CONFIG
        )
    weights = {
        name: tensor.float()
        for name, tensor in network.state_dict().items()
        if not name.startswith("pooler.")
    }
    return weights if of_sound else _of_sound(weights, wanted)


def _of_sound(weights: dict[str, Tensor], wanted: ASTConfig) -> dict[str, Tensor]:
    """Return a DeiT's weights for filterbanks: colours summed, places of patches fitted.

    Of the grid of places the middle is taken, and stretched where it is too small.
    """
    patches = "embeddings.patch_embeddings.projection.weight"
    places = "embeddings.position_embeddings"
    tokens, grid = weights[places][:, :_TOKENS], weights[places][:, _TOKENS:]
    side, patch = round(grid.shape[1] ** 0.5), weights[patches].shape[2]
    rows, columns = (
        (length - patch) // stride + 1
        for length, stride in (
            (wanted.num_mel_bins, wanted.frequency_stride),
            (wanted.max_length, wanted.time_stride),
        )
    )
    top, left = (max(0, (side - needs) // 2) for needs in (rows, columns))
    middle = grid.transpose(1, 2).reshape(1, -1, side, side)[
        :, :, top : top + rows, left : left + columns
    ]
    fitted = functional.interpolate(middle, size=(rows, columns), mode="bilinear")
    return weights | {
        patches: weights[patches].sum(dim=1, keepdim=True),
        places: torch.cat([tokens, fitted.flatten(2).transpose(1, 2)], dim=1),
    }


@torch.no_grad()
def listen(network: ASTModel, filterbanks: Tensor) -> None:
    """Set the layers that a fresh network hears by; its positions tell patches' time and pitch.

    Parameters
    ----------
    network : ASTModel
        Fresh.
    filterbanks : Tensor
        (windows, frames, bands), what it is to hear.
    """
    embeddings = network.embeddings
    first, positions = embeddings.patch_embeddings.projection, embeddings.position_embeddings
    size = first.kernel_size[0]
    patches = filterbanks.unfold(1, size, size).unfold(2, size, size).transpose(3, 4)
    found = components_of(patches.reshape(-1, size**2), min(_COMPONENTS, len(first.weight)))
    tell_components(first, found, _SIZE)
    bands, rows = embeddings.get_shape(embeddings.config)
    half = positions.shape[-1] // 2
    pitch, time = (
        waves(torch.arange(count), math.pi / count, math.pi, half) for count in (bands, rows)
    )
    places = [time.expand(bands, -1, -1), pitch[:, None].expand(-1, rows, -1)]
    positions[0, -bands * rows :] = _SIZE * torch.cat(places, dim=-1).flatten(0, 1)


MASKED_BANDS: Final = 24 / 128
MASKED_ROWS: Final = 96 / 1024
"""Largest shares of bands and of rows that are masked (Park et al. 2019)."""

_NOISE: Final = 0.1
"""Largest size of noise."""

_SHIFT: Final = 10
"""Rows by which a filterbank is shifted, at most."""


def augmented(filterbanks: Tensor) -> tuple[Tensor, Tensor]:
    """Return what is heard of filterbanks (n, frames, bands), and what is to be rebuilt.

    Both are masked alike, up to the shares of the paper; what is heard is also shifted along the
    time by up to ten rows and noisy. Chance is torch's.
    """
    count, frames, bands = filterbanks.shape
    rows = _band(count, frames, MASKED_ROWS)[:, :, None]
    columns = _band(count, bands, MASKED_BANDS)[:, None, :]
    masked = filterbanks.masked_fill((rows | columns).to(filterbanks.device), 0.0)
    shift = int(torch.randint(-_SHIFT, _SHIFT + 1, ()))
    noise = _NOISE * torch.rand(count, 1, 1) * torch.rand(filterbanks.shape)
    return torch.roll(masked + noise.to(filterbanks.device), shift, dims=1), masked


def _band(count: int, size: int, share: float) -> Tensor:
    """Return for each of `count` a run of places, at most a share of them, (count, size)."""
    width = torch.randint(0, max(1, round(share * size)) + 1, (count, 1))
    first = (torch.rand(count, 1) * (size - width + 1)).long()
    places = torch.arange(size)
    return (places >= first) & (places < first + width)
