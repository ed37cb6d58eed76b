"""Reading the weights of a published network, and nothing but numbers, from its checkpoint."""

from __future__ import annotations

import argparse
import pickle
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import torch
from torch import Tensor, nn

from motion.errors import InputError

_PREFIX: Final = "module."
"""Of every name in a checkpoint that several graphics processors wrote."""

_SHOWN: Final = 3


def load_weights(network: nn.Module, file: Path, place: tuple[str, ...]) -> None:
    """Put the weights of a checkpoint into `network`, and set it to evaluation.

    Parameters
    ----------
    network : nn.Module
        With the published names. What the file holds beside its parts, such as a decoder, is left.
    file : Path
        What ``torch.save`` wrote. Only tensors, plain values and the ``argparse.Namespace`` in
        which training scripts keep their options are unpickled; the latter is a bag of attributes
        whose unpickling runs no code.
    place : tuple of str
        The keys below which the weights lie; a file may also hold the weights alone.

    Raises
    ------
    InputError
        If the file is missing, holds other objects, or holds another network's weights.
    """
    found = _read(file)
    for key in place:
        if isinstance(found, Mapping) and isinstance(found.get(key), Mapping):
            found = found[key]
    if not isinstance(found, Mapping):
        raise _unusable(file, "it holds no named weights", place)
    weights = {str(name).removeprefix(_PREFIX): weight for name, weight in found.items()}
    wanted = network.state_dict()
    _check_layout(wanted, weights, file, place)
    network.load_state_dict({name: weights[name] for name in wanted})
    network.eval().requires_grad_(False)


def _read(file: Path) -> object:
    if not file.is_file():
        raise InputError("there is no such file", where=file, remedy="Check the path")
    try:
        with torch.serialization.safe_globals([argparse.Namespace]):
            found: object = torch.load(file, map_location="cpu", weights_only=True)
    except pickle.UnpicklingError as error:
        raise InputError(
            f"the checkpoint holds objects that are not loaded, because loading them could run "
            f"code: {_first_line(error)}",
            where=file,
            remedy="If you trust the file, save its weights alone, where its authors' code runs: "
            "checkpoint = torch.load(FILE, weights_only=False); checkpoint.pop('args', None); "
            "torch.save(checkpoint, NEW_FILE)",
        ) from error
    except (OSError, RuntimeError, EOFError, ValueError, LookupError, TypeError) as error:
        raise InputError(
            f"the file cannot be read as a checkpoint: {_first_line(error)}",
            where=file,
            remedy="Give the file as it was published, and download it again if it is damaged",
        ) from error
    return found


def _first_line(error: Exception) -> str:
    return str(error).strip().partition("\n")[0][:200]


def _check_layout(
    wanted: Mapping[str, Tensor],
    found: Mapping[str, object],
    file: Path,
    place: tuple[str, ...],
) -> None:
    """Raise where the weights are not those of the published network."""
    missing = [name for name in wanted if not isinstance(found.get(name), Tensor)]
    if missing:
        raise _unusable(file, f"{_some(missing)} missing", place)
    other = [
        f"{name} {tuple(there.shape)} instead of {tuple(weight.shape)}"
        for name, weight in wanted.items()
        if isinstance(there := found[name], Tensor) and there.shape != weight.shape
    ]
    parts = {name.partition(".")[0] for name in wanted}
    more = [name for name in found if name.partition(".")[0] in parts and name not in wanted]
    # A variational encoder has a second head, which no feature uses.
    more = [name for name in more if ".fc_logvar." not in name]
    if other:
        raise _unusable(file, f"{_some(other)} of another shape", place)
    if more:
        raise _unusable(file, f"{_some(more)} unknown", place)


def _some(names: list[str]) -> str:
    shown = ", ".join(names[:_SHOWN]) + (", …" if len(names) > _SHOWN else "")
    return f"{len(names)} weights ({shown}) are"


def _unusable(file: Path, why: str, place: tuple[str, ...]) -> InputError:
    return InputError(
        f"the file does not hold the published network: {why}",
        where=file,
        remedy=f"Give the released checkpoint of this preset, with the weights under "
        f"{'.'.join(place)!r}",
    )
