"""A Speech2UnifiedExpressions network with all that its motion depends on, in one file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import torch

from generators.s2ue.config import NetworkConfig
from generators.s2ue.model import Network
from motion.body.face_landmarks import FaceLandmarks
from training.speakers import Speakers
from training.weights_file import NetworkKind

_NETWORK: Final = NetworkKind(
    name="s2ue",
    wanted="a Speech2UnifiedExpressions network of the default body's face",
    remedy="Give one that 'motionjury train s2ue' wrote",
)


@dataclass(frozen=True, kw_only=True, eq=False)
class S2ueNetwork:
    """A network that generates motion.

    Attributes
    ----------
    network : Network
        In evaluation mode, on the CPU.
    speakers : Speakers
        Its speakers.
    vectors : str
        The word vectors that it was trained with.
    training : mapping
        How it was trained, as JSON values.
    """

    network: Network
    speakers: Speakers
    vectors: str
    training: Mapping[str, Any] = field(default_factory=dict)


def write_network(path: Path, network: S2ueNetwork) -> None:
    """Write a network to one safetensors file."""
    _NETWORK.write(
        path,
        network.network,
        network.network.config,
        "network",
        speakers=list(network.speakers.names),
        vectors=network.vectors,
        training=dict(network.training),
    )


def load_network(path: Path, face: FaceLandmarks) -> S2ueNetwork:
    """Return the network of a file that `write_network` wrote.

    Raises
    ------
    InputError
        If the file holds another network, or one of other landmarks than `face` has.
    """
    with _NETWORK.reading(path) as file:
        config = NetworkConfig(**file.facts["config"])
        neutral, expected = file.tensors["network.neutral"], torch.from_numpy(face.neutral)
        if neutral.shape != expected.shape or not torch.allclose(neutral, expected, atol=1e-5):
            raise ValueError("landmarks of another face")
        return S2ueNetwork(
            network=file.loaded(Network(config, face), "network"),
            speakers=Speakers(tuple(file.facts["speakers"]), config.speakers),
            vectors=str(file.facts["vectors"]),
            training=file.facts["training"],
        )
