"""Loading the network that DiffSHEG's authors released, and the statistics of its motion.

Their names for the weights are translated into ours one by one, and every weight of the file must
find its place.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from generators.diffsheg.config import BEAT, SHOW, DenoiserConfig
from generators.diffsheg.model import Denoiser
from motion.errors import InputError
from motion.listing import listed
from training.released_weights import fill, read_saved, renamed, tensors_in
from training.spaces.normalisation import Normalisation

DATASETS: Final[Mapping[str, DenoiserConfig]] = {"beat": BEAT, "show": SHOW}

_STYLED: Final = (
    (r"sa_block\.proj_out\.", "attention.stylization."),
    (r"ffn\.proj_out\.", "feed_forward.stylization."),
    (r"sa_block\.", "attention."),
    (r"ffn\.linear1\.", "feed_forward.widen."),
    (r"ffn\.linear2\.", "feed_forward.narrow."),
    (r"emb_layers\.1\.", "modulation."),
    (r"out_layers\.2\.", "out."),
)

_NAMES: Final = (
    (r"^encoder_aud\.", "audio."),
    (r"^encoder_exp\.", "branches.expression."),
    (r"^encoder_ges\.", "branches.gesture."),
    (r"time_embed\.0\.", "step.first."),
    (r"time_embed\.2\.", "step.second."),
    (r"pid_embed\.0\.", "speaker.first."),
    (r"pid_embed\.2\.", "speaker.second."),
    (r"PE\.pe$", "position"),
    (r"joint_embed\.", "inward."),
    (r"audio_proj\.", "audio."),
    (r"hubert_encoder\.0\.", "speech.first."),
    (r"hubert_encoder\.1\.", "speech.norm."),
    (r"hubert_encoder\.3\.", "speech.second."),
    (r"temporal_decoder_blocks\.(\d+)\.feat_proj\.0\.", r"fusions.\1.norm."),
    (r"temporal_decoder_blocks\.(\d+)\.feat_proj\.1\.", r"fusions.\1.widen."),
    (r"temporal_decoder_blocks\.(\d+)\.feat_proj\.3\.", r"fusions.\1.narrow."),
    (r"temporal_decoder_blocks\.(\d+)\.", r"blocks.\1."),
    (r"null_cond_emb$", "unconditioned"),
    (r"\.out\.(weight|bias)$", r".outward.\1"),
    *_STYLED,
)
"""Patterns of the release's names and what they are here, applied in order."""

_STATISTICS: Final = (
    "Name the folder that holds axis_angle_mean.npy, axis_angle_std.npy, json_mean.npy and "
    "json_std.npy, as released beside the checkpoint"
)


def load_released(path: str | Path, dataset: str = "beat") -> Denoiser:
    """Return the released network, ready to be asked.

    Parameters
    ----------
    path : path
        What ``torch.save(state_dict)`` or safetensors wrote: the weights alone, or under the key
        ``encoder``. Nothing but tensors is ever unpickled.
    dataset : {'beat', 'show'}
        What it was trained on.

    Returns
    -------
    Denoiser
        In evaluation mode, on the CPU.

    Raises
    ------
    InputError
        If the file cannot be read, or is not such a network: it names the weights that are
        missing, unknown or of another shape.
    """
    if dataset not in DATASETS:
        raise InputError(
            f"DiffSHEG was not released for {dataset!r}", remedy=f"Use {listed(list(DATASETS))}"
        )
    file = Path(path)
    weights = renamed(read_weights(file), _NAMES)
    with torch.device("meta"):
        denoiser = Denoiser(DATASETS[dataset])
    return fill(
        denoiser,
        weights,
        file,
        f"DiffSHEG's network for {dataset}",
        "Name the dataset it was trained on, or give the released checkpoint",
    )


def read_weights(file: Path) -> dict[str, Tensor]:
    """Return the tensors of a file by name, those under ``encoder`` where there is that key.

    Raises
    ------
    InputError
        If the file is not there, or holds anything but tensors.
    """
    found = read_saved(file)
    if isinstance(found, Mapping) and isinstance(found.get("encoder"), Mapping):
        found = found["encoder"]
    if isinstance(found, Mapping) and all(str(name).startswith("encoder.") for name in found):
        found = {name.removeprefix("encoder."): weight for name, weight in found.items()}
    return tensors_in(found, file)


def read_normalisation(folder: Path, config: DenoiserConfig) -> Normalisation:
    """Read mean and standard deviation as DiffSHEG's release holds them.

    Parameters
    ----------
    folder : Path
        ``axis_angle_mean.npy`` and ``axis_angle_std.npy`` of the body, ``json_mean.npy`` and
        ``json_std.npy`` of the face, beside them or in ``facial52/``.
    config : DenoiserConfig
        How many values each has.

    Raises
    ------
    InputError
        If a file is missing, cannot be read, or is of another size.
    """
    parts = (("axis_angle", config.gesture_width), ("json", config.expression_width))
    mean, std = (
        np.concatenate(
            [_read_statistic(folder, f"{part}_{kind}.npy", width) for part, width in parts]
        )
        for kind in ("mean", "std")
    )
    if (std < 0).any():
        raise InputError("a standard deviation is negative", where=folder, remedy=_STATISTICS)
    return Normalisation(mean, std)


def _read_statistic(folder: Path, name: str, width: int) -> NDArray[np.float64]:
    path = next(
        (path for path in (folder / name, folder / "facial52" / name) if path.is_file()),
        folder / name,
    )
    try:
        values = np.load(path, allow_pickle=False)
    except FileNotFoundError as error:
        raise InputError("there is no such file", where=path, remedy=_STATISTICS) from error
    except (OSError, EOFError, ValueError) as error:
        raise InputError(
            "the file cannot be read as a plain array", where=path, remedy=_STATISTICS
        ) from error
    if values.shape != (width,) or values.dtype.kind not in "fiu" or not np.isfinite(values).all():
        raise InputError(
            f"the array has shape {values.shape} and type {values.dtype}, and {width} finite "
            "numbers are needed",
            where=path,
            remedy=_STATISTICS,
        )
    return np.asarray(values, dtype=np.float64)
