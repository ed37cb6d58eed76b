"""Weights that AMUSE's three encoders set out from: of an AST, or of a DeiT for images.

A DeiT becomes an AST as Gong et al. 2021 (section 2.2) make one.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Final

import torch
from safetensors import SafetensorError
from torch import Tensor
from torch.nn import functional
from transformers import ASTModel, DeiTModel

from generators.amuse.config import SpeechConfig
from generators.amuse.speech import SpeechEncoder
from motion.errors import InputError
from motion.listing import listed

WEIGHTS: Final = "model.safetensors"

_AST: Final = "audio-spectrogram-transformer"
_DEIT: Final = "deit"
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

_REMEDY: Final = (
    "Give the folder that transformers' save_pretrained wrote of an AST or a distilled DeiT of the "
    "encoders' size, with config.json and model.safetensors; or another --config"
)


def read_encoder_weights(folder: Path, config: SpeechConfig) -> dict[str, Tensor]:
    """Return the weights of one encoder's transformer by name.

    Parameters
    ----------
    folder : Path
        What ``save_pretrained`` wrote of an AST or of a DeiT. Nothing but safetensors is read, and
        nothing is fetched.
    config : SpeechConfig
        Sizes of the encoder.

    Raises
    ------
    InputError
        If the folder holds no such network, one of another size, or one that lacks weights.
    """
    with torch.device("meta"):
        wanted = SpeechEncoder(config).transformer
    kind = _checked(folder, wanted)
    options: dict[str, Any] = {} if kind == _AST else {"add_pooling_layer": False}
    try:
        network, report = (ASTModel if kind == _AST else DeiTModel).from_pretrained(
            folder, local_files_only=True, use_safetensors=True, output_loading_info=True, **options
        )
    except (SafetensorError, OSError, ValueError, RuntimeError, KeyError, TypeError) as error:
        what = str(error).partition("\n")[0]
        raise _refused(f"the encoders' weights cannot be read: {what}", folder) from error
    missing = sorted(report["missing_keys"])
    if missing:
        raise _refused(
            f"the file lacks {len(missing)} of an encoder's weights ({', '.join(missing[:3])})",
            folder / WEIGHTS,
        )
    weights = {name: tensor.float() for name, tensor in network.state_dict().items()}
    return weights if kind == _AST else _of_sound(weights, config)


def _checked(folder: Path, wanted: ASTModel) -> str:
    """Return which network the folder holds, or say what is wrong there."""
    for name in ("config.json", WEIGHTS):
        if not (folder / name).is_file():
            raise _refused(f"the folder of the encoders' weights holds no {name}", folder)
    path = folder / "config.json"
    try:
        facts = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise _refused("the file is no JSON", path) from error
    kind = facts.get("model_type") if isinstance(facts, dict) else None
    if kind not in (_AST, _DEIT):
        raise _refused(f"the folder holds a network of type {kind!r}, not an AST or a DeiT", path)
    found = (ASTModel if kind == _AST else DeiTModel).config_class.from_dict(facts)
    other = [
        f"{name} {getattr(found, name)} in place of {getattr(wanted.config, name)}"
        for name in (*_SIZES, *(_OF_SOUND if kind == _AST else ()))
        if getattr(found, name) != getattr(wanted.config, name)
    ]
    if other:
        raise _refused(f"the network has another size than the encoders: {listed(other)}", path)
    return str(kind)


def _of_sound(weights: dict[str, Tensor], config: SpeechConfig) -> dict[str, Tensor]:
    """Return a DeiT's weights for filterbanks: colours summed, places of patches fitted."""
    patches = "embeddings.patch_embeddings.projection.weight"
    places = "embeddings.position_embeddings"
    tokens, grid = weights[places][:, :_TOKENS], weights[places][:, _TOKENS:]
    side = round(grid.shape[1] ** 0.5)
    fitted = _fitted(
        grid.transpose(1, 2).reshape(1, -1, side, side),
        *(
            (length - patch) // config.patch_stride + 1
            for length, patch in zip(
                (config.bands, config.frames), weights[patches].shape[2:], strict=True
            )
        ),
    )
    return weights | {
        patches: weights[patches].sum(dim=1, keepdim=True),
        places: torch.cat([tokens, fitted.flatten(2).transpose(1, 2)], dim=1),
    }


def _fitted(grid: Tensor, rows: int, columns: int) -> Tensor:
    """Return the middle of a grid (1, width, rows, columns), stretched where it is too small."""
    first, left = (
        max(0, (has - needs) // 2)
        for has, needs in zip(grid.shape[2:], (rows, columns), strict=True)
    )
    middle = grid[:, :, first : first + rows, left : left + columns]
    return functional.interpolate(middle, size=(rows, columns), mode="bilinear")


def _refused(what: str, where: Path) -> InputError:
    return InputError(what, where=where, remedy=_REMEDY)
