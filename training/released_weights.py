"""Files of weights that other people's code wrote; nothing in them but tensors is unpickled."""

from __future__ import annotations

import pickle
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor, nn

from motion.errors import InputError
from motion.listing import listed

Network = TypeVar("Network", bound=nn.Module)


def read_saved(file: Path) -> object:
    """Return what ``torch.save`` or safetensors wrote.

    Raises
    ------
    InputError
        If the file is not there, or holds anything but tensors in containers.
    """
    if not file.is_file():
        raise InputError("there is no such file", where=file, remedy="Name the checkpoint's file")
    try:
        return load_file(file)
    except SafetensorError:
        pass
    try:
        return torch.load(file, map_location="cpu", weights_only=True)
    except (pickle.UnpicklingError, RuntimeError, EOFError, ValueError, KeyError) as error:
        raise not_weights(file, str(error).partition("\n")[0]) from None


def tensors_in(found: object, file: Path) -> dict[str, Tensor]:
    """Return the tensors of a state dictionary by name, without the prefix ``module.``.

    Raises
    ------
    InputError
        If it is no mapping, or holds anything but tensors.
    """
    if not isinstance(found, Mapping) or not all(isinstance(one, Tensor) for one in found.values()):
        raise not_weights(file, "it holds more than named tensors")
    return {str(name).removeprefix("module."): weight for name, weight in found.items()}


def renamed(
    weights: Mapping[str, Tensor], patterns: Sequence[tuple[str, str]]
) -> dict[str, Tensor]:
    """Return weights under the names that patterns and what stands for them give, in order."""
    found = {}
    for name, weight in weights.items():
        for pattern, replacement in patterns:
            name = re.sub(pattern, replacement, name)
        found[name] = weight
    return found


def not_weights(file: Path, why: str) -> InputError:
    """Return the error for a file that holds no weights."""
    return InputError(
        f"this is not a file of network weights: {why}",
        where=file,
        remedy="Give what torch.save(state_dict) or safetensors wrote, with tensors only",
    )


def fill(
    network: Network, weights: Mapping[str, Tensor], file: Path, whose: str, remedy: str
) -> Network:
    """Give a network of the meta device the weights of a file; return it, ready to be asked.

    Parameters
    ----------
    network : Module
        Made on the meta device, so that its weights take no memory of their own.
    weights : mapping of str to Tensor
        By the network's own names.
    file : Path
        Where they come from.
    whose : str
        What the file should be, as in ``DiffSHEG's network for beat``.
    remedy : str
        What to do where it is another.

    Raises
    ------
    InputError
        If weights are missing, unknown, or of another shape: it names them.
    """
    wanted = network.state_dict()
    problems = [
        f"{len(names)} {what} ({', '.join(names[:3])}{', …' if len(names) > 3 else ''})"
        for what, names in _misfits(wanted, weights)
        if names
    ]
    if problems:
        raise InputError(f"this is not {whose}: {listed(problems)}", where=file, remedy=remedy)
    typed = {name: weight.to(wanted[name].dtype) for name, weight in weights.items()}
    network.load_state_dict(typed, assign=True)
    network.requires_grad_(False).eval()
    return network


def _misfits(
    wanted: Mapping[str, Tensor], found: Mapping[str, Tensor]
) -> Sequence[tuple[str, list[str]]]:
    other = [
        f"{name} {tuple(found[name].shape)} instead of {tuple(weight.shape)}"
        for name, weight in wanted.items()
        if name in found and found[name].shape != weight.shape
    ]
    return (
        ("missing", [name for name in wanted if name not in found]),
        ("unknown", [name for name in found if name not in wanted]),
        ("of another shape", other),
    )
