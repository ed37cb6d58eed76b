"""What metrics ask of a feature network, whoever trained it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from analysis.metrics import network_names as names
from motion.clip import MotionClip

_OF_CHANNELS: Final = {
    "body": names.EMOTION,
    "landmarks": names.LANDMARKS,
    "gesture": names.GESTURE,
    "expression": names.EXPRESSION,
    "both": names.WHOLE,
}

_SEES: Final = {
    names.EMOTION: frozenset[str](),
    names.GESTURE: frozenset[str](),
    names.WHOLE: frozenset[str](),
    names.EXPRESSION: frozenset({"face"}),
    names.LANDMARKS: frozenset({"face"}),
}

_COMMANDS: Final = {
    names.EMOTION: "motionjury train evaluator emotion",
    names.GESTURE: "motionjury train evaluator motion",
    names.EXPRESSION: "motionjury train evaluator motion --channels expression",
    names.WHOLE: "motionjury train evaluator motion --channels both",
    names.LANDMARKS: "motionjury train evaluator face",
}


def command_for(name: str) -> str:
    """Return the command that trains a network of that name."""
    return _COMMANDS[name]


class FeatureNetwork(Protocol):
    """A network that turns clips into features, and of kind ``emotion`` into emotions too."""

    @property
    def channels(self) -> str:
        """What it looks at: ``body``, ``gesture``, ``expression``, ``both`` or ``landmarks``."""

    @property
    def sha256(self) -> str:
        """Hash of its file."""

    @property
    def labels(self) -> Sequence[str]:
        """The emotions that it tells apart; none for other kinds."""

    def describe(self) -> Mapping[str, str]:
        """Return the settings that every score quotes."""

    def embed(self, clip: MotionClip) -> NDArray[np.float32]:
        """Return one row of features for each window of `clip`, shape (w, d)."""

    def classify(self, clip: MotionClip) -> NDArray[np.float32]:
        """Return how much each emotion speaks for itself in each window, shape (w, labels)."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """One feature network among those that a run measures with.

    Attributes
    ----------
    path : Path
        Its file.
    sha256 : str
        Hash of the file.
    name : str
        As in `analysis.metrics.network_names`, with the start of the hash where several networks
        of one kind are measured with.
    settings : mapping of str to str
        What every score quotes.
    labels : tuple of str
        Emotions that it tells apart; none for networks that do not.
    sees : frozenset of str
        Channels (`motion.freeze`) without which it has nothing to look at: where a study holds
        all of them still, it measures nothing.
    """

    path: Path
    sha256: str
    name: str
    settings: Mapping[str, str]
    labels: tuple[str, ...] = ()
    sees: frozenset[str] = frozenset()


def open_network(path: Path) -> FeatureNetwork:
    """Return the network in the file `path`.

    Raises
    ------
    InputError
        If the file is no network that ``motionjury train evaluator`` has made.
    """
    # Imported here: torch takes seconds to load, and most metrics do without.
    from analysis.metrics.networks import load_evaluator

    network: FeatureNetwork = load_evaluator(path)
    return network


def networks(paths: Iterable[Path]) -> tuple[Network, ...]:
    """Return what is known of the networks in files; the same file is taken once.

    Raises
    ------
    InputError
        If a file is no such network.
    """
    found: dict[str, tuple[Path, FeatureNetwork]] = {}
    for path in paths:
        network = open_network(path)
        found.setdefault(network.sha256, (path, network))
    names_there = [_OF_CHANNELS[network.channels] for _, network in found.values()]
    result = []
    for name, (path, network) in zip(names_there, found.values(), strict=True):
        several = names_there.count(name) > 1
        result.append(
            Network(
                path=path,
                sha256=network.sha256,
                name=f"{name}, {network.sha256[:8]}" if several else name,
                settings=dict(network.describe()),
                labels=tuple(network.labels),
                sees=_SEES[name],
            )
        )
    return tuple(result)
