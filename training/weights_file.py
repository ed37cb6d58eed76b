"""Files of weights: safetensors with a JSON object of facts; nothing in them is ever run."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, TypeVar

from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from motion.errors import InputError
from motion.files import replacing

Network = TypeVar("Network", bound=nn.Module)

_KEY: Final = "motionjury"
"""All facts are one entry: safetensors keeps no order among several, and equal runs are to make
equal bytes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WeightsFile:
    """What such a file holds.

    Attributes
    ----------
    tensors : mapping of str to Tensor
        On the CPU.
    facts : mapping
        JSON values.
    """

    tensors: Mapping[str, Tensor]
    facts: Mapping[str, Any]

    def part(self, prefix: str) -> dict[str, Tensor]:
        """Return the tensors whose names begin with ``prefix.``, without it."""
        start = f"{prefix}."
        return {
            name.removeprefix(start): tensor
            for name, tensor in self.tensors.items()
            if name.startswith(start)
        }

    def config(self, kind: str) -> dict[str, Any]:
        """Return the sizes of the network; ValueError if it is none of that kind."""
        if self.facts["network"] != kind:
            raise ValueError("another network")
        return dict(self.facts["config"])

    def loaded(self, network: Network, part: str) -> Network:
        """Return a network with the weights of a part, in evaluation mode."""
        network.load_state_dict(self.part(part))
        network.requires_grad_(False).eval()
        return network


@contextmanager
def holding(path: Path, wanted: str, remedy: str) -> Iterator[None]:
    """Say that the file holds no such network where it lacks something that is looked for.

    Raises
    ------
    InputError
        If a fact or a tensor is missing, or of another shape.
    """
    try:
        yield
    except (KeyError, TypeError, ValueError, RuntimeError, AttributeError) as error:
        raise InputError(
            f"the file holds weights, but not of {wanted}", where=path, remedy=remedy
        ) from error


def tensors_of(parts: Mapping[str, nn.Module]) -> dict[str, Tensor]:
    """Return the weights of networks as a file holds them, each as ``part.name``."""
    return {
        f"{part}.{name}": tensor
        for part, network in parts.items()
        for name, tensor in network.state_dict().items()
    }


def write_weights(path: Path, tensors: Mapping[str, Tensor], facts: Mapping[str, Any]) -> None:
    """Write tensors and facts to `path` in one step; equal content makes equal bytes.

    Raises
    ------
    InputError
        If they cannot be stored there, as on a full disk.
    """
    plain = {name: tensor.detach().cpu().contiguous() for name, tensor in tensors.items()}
    text = json.dumps(facts, sort_keys=True, allow_nan=False)
    with replacing(path) as draft:
        try:
            save_file(plain, draft, metadata={_KEY: text})
        except SafetensorError as error:
            raise InputError(
                f"the weights cannot be stored: {error}",
                where=path,
                remedy="Make room on the disk, or name another place",
            ) from error


def holds_facts(path: Path) -> bool:
    """Tell whether `path` is a file that `write_weights` wrote, and not another program's."""
    try:
        with safe_open(path, framework="pt") as file:
            return _KEY in (file.metadata() or {})
    except (SafetensorError, OSError):
        return False


def read_weights(path: Path) -> WeightsFile:
    """Read what `write_weights` wrote.

    Raises
    ------
    InputError
        If the file is missing, damaged, of another format, or written by another program.
    """
    if not path.is_file():
        raise InputError("there is no such file of weights", where=path, remedy="Check the path")
    try:
        with safe_open(path, framework="pt") as file:
            metadata = file.metadata() or {}
            # The file's order is that of sizes and names; `keys` is no mapping's.
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as error:
        raise InputError(
            "the file holds no weights: it is no safetensors file, or damaged",
            where=path,
            remedy="Give a file that 'motionjury train' wrote, or train again",
        ) from error
    try:
        facts = json.loads(metadata[_KEY])
        if not isinstance(facts, dict):
            raise ValueError("no object")
    except (KeyError, ValueError) as error:
        raise InputError(
            "the file does not say what its weights are",
            where=path,
            remedy="Give a file that 'motionjury train' wrote; other programs' weights do not fit",
        ) from error
    return WeightsFile(tensors=tensors, facts=facts)
