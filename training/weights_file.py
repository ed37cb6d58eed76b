"""Files of weights: safetensors with a JSON object of facts; reading them runs no code."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final, Generic, Self, TypeVar

from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor, nn

from motion.errors import InputError
from motion.files import replacing
from training.run.launching import is_leader
from training.speakers import Speakers

Network = TypeVar("Network", bound=nn.Module)

_KEY: Final = "motionjury"
"""All facts are one entry: safetensors keeps no order among several, and equal runs must give equal
bytes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class WeightsFile:
    """The content of a file of weights.

    Attributes
    ----------
    tensors : mapping of str to Tensor
        Tensors by name, on the CPU.
    facts : mapping
        Facts about the network, as JSON values.
    """

    tensors: Mapping[str, Tensor]
    facts: Mapping[str, Any]

    def with_prefix(self, prefix: str) -> dict[str, Tensor]:
        """Return the tensors named ``prefix.*`` without the prefix; all if `prefix` is empty."""
        start = prefix and f"{prefix}."
        return {
            name.removeprefix(start): tensor
            for name, tensor in self.tensors.items()
            if name.startswith(start)
        }

    def loaded(self, network: Network, part: str = "") -> Network:
        """Load the weights of `part`, or all, into a network; return it in evaluation mode."""
        network.load_state_dict(self.with_prefix(part))
        network.requires_grad_(False).eval()
        return network

    def speakers(self, width: int) -> Speakers | None:
        """Return the speakers of a network with one-hot vectors of `width`."""
        names = self.facts.get("speakers")
        return None if names is None else Speakers(tuple(names), width)


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainedNetwork(Generic[Network]):
    """A network with the facts in its file.

    Attributes
    ----------
    model : Module
        The network, in evaluation mode, on the CPU; its ``config`` is a dataclass.
    speakers : Speakers or None
        Its speakers; None if it has none, or if only their numbers are known.
    training : mapping
        How it was trained, as JSON values; empty if unknown.
    """

    model: Network
    speakers: Speakers | None = None
    training: Mapping[str, Any] = field(default_factory=dict)

    def to(self, device: str) -> Self:
        """Move the network to a device, and return itself."""
        self.model.to(device)
        return self


@dataclass(frozen=True, kw_only=True)
class NetworkKind:
    """A kind of network file, and the errors for other files.

    Attributes
    ----------
    name : str
        The network's name in the file's facts.
    wanted : str
        Description of the expected network, as in ``a DiffSHEG network``.
    remedy : str
        Remedy for another file; by default, to give the expected one.
    """

    name: str
    wanted: str
    remedy: str = ""

    def write(
        self,
        path: Path,
        network: TrainedNetwork[Any],
        part: str = "",
        tensors: Mapping[str, Tensor] = MappingProxyType({}),
        **facts: Any,
    ) -> None:
        """Write a network, its weights under the name `part`, with further tensors and facts.

        If several processes train together, only the leading one writes.
        """
        if not is_leader():
            return
        start = part and f"{part}."
        weights = {f"{start}{name}": w for name, w in network.model.state_dict().items()}
        facts |= {"network": self.name, "config": asdict(network.model.config)}
        facts |= {"training": dict(network.training)}
        if network.speakers is not None:
            facts["speakers"] = list(network.speakers.names)
        write_weights(path, {**weights, **tensors}, facts)

    @contextmanager
    def reading(self, path: Path) -> Iterator[WeightsFile]:
        """Open a file of this kind.

        Raises
        ------
        InputError
            If the file cannot be read, or a fact or tensor that the block reads is missing or has
            another shape.
        """
        file = read_weights(path)
        default_remedy = f"Give {self.wanted}: one that was trained here, or the released one"
        try:
            if file.facts["network"] != self.name:
                raise ValueError("another network")
            yield file
        except (KeyError, TypeError, ValueError, RuntimeError, AttributeError) as error:
            raise InputError(
                f"the file holds weights, but not of {self.wanted}",
                where=path,
                remedy=self.remedy or default_remedy,
            ) from error


def write_weights(path: Path, tensors: Mapping[str, Tensor], facts: Mapping[str, Any]) -> None:
    """Write tensors and facts to `path` in one step; equal content gives equal bytes.

    Raises
    ------
    InputError
        If they cannot be written, as on a full disk.
    """
    stored = {name: tensor.detach().cpu().contiguous() for name, tensor in tensors.items()}
    text = json.dumps(facts, sort_keys=True, allow_nan=False)
    with replacing(path) as draft:
        try:
            save_file(stored, draft, metadata={_KEY: text})
        except SafetensorError as error:
            raise InputError(
                f"the weights cannot be stored: {error}",
                where=path,
                remedy="Free space on the disk, or name another folder",
            ) from error


def holds_facts(path: Path) -> bool:
    """Return whether `path` is a file that `write_weights` wrote."""
    try:
        with safe_open(path, framework="pt") as file:
            return _KEY in (file.metadata() or {})
    except (SafetensorError, OSError):
        return False


def read_weights(path: Path) -> WeightsFile:
    """Read a file that `write_weights` wrote.

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
            # The file's order is by size and name; `file` is not a mapping.
            tensors = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as error:
        raise InputError(
            "the file holds no weights: it is not a safetensors file, or is damaged",
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
