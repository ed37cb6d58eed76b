"""Weights written by other people's code: files of them, and folders of `transformers`.

Nothing is downloaded, and nothing but tensors is unpickled.
"""

from __future__ import annotations

import json
import pickle
import re
import tomllib
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import shorten
from typing import TYPE_CHECKING, Any, Final, TypeVar

import numpy as np
import torch
from safetensors import SafetensorError
from safetensors.torch import load_file
from torch import Tensor, nn

from motion.arrays import Floats
from motion.errors import InputError

Network = TypeVar("Network", bound=nn.Module)

_LONGEST_PROBLEM: Final = 300
"""Characters of torch's list of the weights that do not fit."""


def read_saved(file: Path) -> object:
    """Return the content of a file of ``torch.save`` or safetensors.

    Raises
    ------
    InputError
        If the file is missing, or holds anything but tensors in containers.
    """
    if not file.is_file():
        raise InputError("there is no such file", where=file, remedy="Name the checkpoint's file")
    try:
        return load_file(file)
    except SafetensorError:
        pass
    try:
        return torch.load(file, map_location="cpu", weights_only=True)
    except (
        *(pickle.UnpicklingError, OSError, RuntimeError, EOFError),
        *(ValueError, LookupError, TypeError),
    ):
        # torch's own message advises unpickling it anyway.
        raise not_weights_error(file, "it is damaged, or holds more than tensors") from None


def tensors_in(content: object, file: Path) -> dict[str, Tensor]:
    """Return the tensors of a state dictionary by name, without the prefix ``module.``.

    Raises
    ------
    InputError
        If it is not a mapping of tensors.
    """
    if not isinstance(content, Mapping) or not all(isinstance(v, Tensor) for v in content.values()):
        raise not_weights_error(file, "it holds more than named tensors")
    return {str(name).removeprefix("module."): weight for name, weight in content.items()}


def read_numbers(file: Path, count: int, remedy: str) -> Floats:
    """Return the numbers of a ``.npy`` file, shape (count,).

    Raises
    ------
    InputError
        If the file is missing, or holds anything but `count` finite numbers.
    """
    try:
        values = np.load(file, allow_pickle=False).astype(np.float64)
        if values.size != count or not np.isfinite(values).all():
            raise ValueError(f"shape {values.shape}")
    except (OSError, EOFError, ValueError) as error:
        raise InputError(
            f"this is not an array of {count} finite numbers: {error}", where=file, remedy=remedy
        ) from error
    return np.asarray(values.reshape(-1))


@dataclass(frozen=True)
class ReleasedNames:
    """Renaming of released weights.

    Attributes
    ----------
    renamed : sequence of pair of str
        Patterns and their replacements, applied in order.
    unused : str
        Pattern of the names of weights that are ignored.
    """

    renamed: Sequence[tuple[str, str]]
    unused: str = "$^"

    @classmethod
    def read(cls, file: Path) -> ReleasedNames:
        """Read the names from a TOML file."""
        return cls(**tomllib.loads(file.read_text("utf-8")))

    def renamed_weights(self, weights: Mapping[str, Tensor]) -> dict[str, Tensor]:
        """Return the weights that we use, under our names."""
        return {
            self._rename(name): weight
            for name, weight in weights.items()
            if not re.search(self.unused, name)
        }

    def _rename(self, name: str) -> str:
        for pattern, replacement in self.renamed:
            name = re.sub(pattern, replacement, name)
        return name


def not_weights_error(file: Path, reason: str) -> InputError:
    """Return the error for a file without weights."""
    return InputError(
        f"this is not a file of network weights: {reason}",
        where=file,
        remedy="Give what torch.save(state_dict) or safetensors wrote, with tensors only",
    )


def fill(
    network: Network, weights: Mapping[str, Tensor], file: Path, description: str, remedy: str
) -> Network:
    """Load the weights of a file into a network on the meta device; return it, ready to run.

    Parameters
    ----------
    network : Module
        The network, made on the meta device so that its weights take no extra memory.
    weights : mapping of str to Tensor
        Weights by the network's own names.
    file : Path
        The file they are from.
    description : str
        Description of the expected file, as in ``DiffSHEG's network for beat``.
    remedy : str
        Remedy for another file.

    Raises
    ------
    InputError
        If weights are missing, unknown, or of another shape.
    """
    types = {name: weight.dtype for name, weight in network.state_dict().items()}
    typed = {name: weight.to(types.get(name)) for name, weight in weights.items()}
    try:
        network.load_state_dict(typed, assign=True)
    except RuntimeError as error:
        problem = shorten(str(error).partition("\n")[2], _LONGEST_PROBLEM)
        raise InputError(
            f"this is not {description}: {problem}", where=file, remedy=remedy
        ) from error
    network.requires_grad_(False).eval()
    return network


if TYPE_CHECKING:
    from transformers import PreTrainedModel

WEIGHTS: Final = "model.safetensors"
CONFIG: Final = "config.json"


@dataclass(frozen=True, kw_only=True)
class SavedNetworks:
    """The networks that a folder may hold, and the remedy if it holds none of them.

    Attributes
    ----------
    owner : str
        Name of the network.
    types : mapping of str to str
        The networks' names by their type in ``config.json``.
    remedy : str
        How to make such a folder.
    optional : collection of str
        Prefixes of the names of weights that may be missing.
    """

    owner: str
    types: Mapping[str, str]
    remedy: str
    optional: Collection[str] = ()

    def check(self, folder: Path) -> Mapping[str, Any]:
        """Return the content of ``config.json``; the weights are not loaded.

        Raises
        ------
        InputError
            If a file is missing, or the folder holds another network.
        """
        for name in (CONFIG, WEIGHTS):
            if not (folder / name).is_file():
                raise self.error(f"the folder of {self.owner} holds no {name}", folder)
        path = folder / CONFIG
        try:
            facts = json.loads(path.read_text(encoding="utf-8"))
        except ValueError as error:
            raise self.error("the file is not JSON", path) from error
        kind = facts.get("model_type") if isinstance(facts, dict) else None
        if kind not in self.types:
            expected = " or ".join(self.types.values())
            raise self.error(f"the folder holds a network of type {kind!r}, not {expected}", path)
        return dict(facts)

    def load(self, folder: Path) -> PreTrainedModel:
        """Return the network that ``save_pretrained`` wrote.

        Raises
        ------
        InputError
            If the folder holds another network, or lacks a weight.
        """
        self.check(folder)
        from transformers import AutoModel

        try:
            network, report = AutoModel.from_pretrained(
                folder, local_files_only=True, use_safetensors=True, output_loading_info=True
            )
        except (SafetensorError, OSError, ValueError, RuntimeError, KeyError, TypeError) as error:
            problem = str(error).partition("\n")[0]
            raise self.error(
                f"the weights of {self.owner} cannot be read: {problem}", folder
            ) from (error)
        missing = sorted(
            name for name in report["missing_keys"] if not name.startswith(tuple(self.optional))
        )
        if missing:
            raise self.error(
                f"the file of {self.owner} lacks {len(missing)} weights ({', '.join(missing[:3])})",
                folder / WEIGHTS,
            )
        return network

    def error(self, problem: str, where: Path) -> InputError:
        """Return the error for a folder without the expected files."""
        return InputError(problem, where=where, remedy=self.remedy)
