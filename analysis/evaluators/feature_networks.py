"""What metrics ask of a feature network, whoever trained it, and what it says about one clip."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final, Protocol

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators import network_names as names
from analysis.metrics.frechet import Rule
from motion.clip import MotionClip
from motion.errors import InputError

_SEES_THE_FACE: Final = (names.EXPRESSION, names.LANDMARKS)
"""Networks that have nothing else to look at."""

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


@dataclass(frozen=True, kw_only=True)
class PublishedFile:
    """A published network's checkpoint.

    Attributes
    ----------
    preset : str
        Which network; a key of `analysis.evaluators.network_names.PUBLISHED`.
    file : Path
        Its checkpoint.
    statistics : Path or None
        For ``beat``, the folder of its mean and spread; None for that of the checkpoint.
    """

    preset: str
    file: Path
    statistics: Path | None = None


Source = Path | PublishedFile
"""Where a network is: a file of ``motionjury train evaluator``, or a published one's."""


class FeatureNetwork(Protocol):
    """A network that turns clips into features, and of kind ``emotion`` into emotions too."""

    @property
    def name(self) -> str:
        """Which kind it is; a name in `analysis.evaluators.network_names`."""

    @property
    def sha256(self) -> str:
        """Hash of its file."""

    @property
    def rule(self) -> Rule | None:
        """By which rule published code takes distances in its features, if it is published."""

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
    source : Path or PublishedFile
        Where it is.
    sha256 : str
        Hash of the file.
    name : str
        As in `analysis.evaluators.network_names`, with the start of the hash where
        several networks of one kind are measured with.
    settings : mapping of str to str
        What every score quotes.
    labels : tuple of str
        Emotions that it tells apart; none for networks that do not.
    sees : frozenset of str
        Channels (`motion.clip`) without which it has nothing to look at: where a study holds
        all of them still, it measures nothing.
    rule : {'pytorch-fid', 'offset'} or None
        By which rule published code takes distances in its features
        (`analysis.metrics.frechet`); None for networks trained here.
    """

    source: Source
    sha256: str
    name: str
    settings: Mapping[str, str]
    labels: tuple[str, ...] = ()
    sees: frozenset[str] = frozenset()
    rule: Rule | None = None


def open_network(source: Source) -> FeatureNetwork:
    """Return the network of a file.

    In a process that another one started, torch is left one thread: such processes share the
    processors already.

    Raises
    ------
    InputError
        If the file holds no such network.
    """
    # Imported here: torch takes seconds to load, and most metrics do without.
    import torch

    if multiprocessing.parent_process() is not None:
        torch.set_num_threads(1)
    if isinstance(source, PublishedFile):
        from analysis.evaluators.published import load_published

        return load_published(source.preset, source.file, statistics=source.statistics)
    from analysis.evaluators.evaluator import load_evaluator

    return load_evaluator(source)


def networks(sources: Iterable[Source]) -> tuple[Network, ...]:
    """Return what is known of the networks in files; the same file is taken once.

    Raises
    ------
    InputError
        If a file is no such network.
    """
    found: dict[str, tuple[Source, FeatureNetwork]] = {}
    for source in sources:
        network = open_network(source)
        found.setdefault(network.sha256, (source, network))
    kinds = [network.name for _, network in found.values()]
    result = []
    for kind, (source, network) in zip(kinds, found.values(), strict=True):
        several = kinds.count(kind) > 1
        result.append(
            Network(
                source=source,
                sha256=network.sha256,
                name=f"{kind}, {network.sha256[:8]}" if several else kind,
                settings=dict(network.describe()),
                labels=tuple(network.labels),
                sees=frozenset({"face"} if kind in _SEES_THE_FACE else ()),
                rule=network.rule,
            )
        )
    return tuple(result)


Array = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipFeatures:
    """What a network says about one clip.

    Attributes
    ----------
    features : ndarray, shape (w, d), float32
        One row per window of the clip; no row where there is a `reason`.
    emotions : ndarray, shape (w, labels), float32
        How much each emotion speaks for itself; no column for networks that tell none apart.
    reason : str
        Why the network cannot look at the clip; empty where it can.
    """

    features: Array = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    emotions: Array = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    reason: str = ""

    @property
    def named(self) -> int | None:
        """Which emotion the clip is taken for, by the mean over its windows; None without."""
        return int(self.emotions.mean(axis=0).argmax()) if self.emotions.size else None


def clip_features(
    network: Network,
    frozen: tuple[str, ...],
    kept: Callable[[Callable[[MotionClip], Array]], Array],
) -> ClipFeatures:
    """Return what a network says about one clip, or why it says nothing.

    Parameters
    ----------
    network : Network
        Which one.
    frozen : tuple of str
        Channels that the study holds still.
    kept : callable
        Gives the array that a function computes of the clip, or what is kept of it.
    """
    if network.sees and network.sees <= set(frozen):
        return ClipFeatures(reason=f"the study holds still: {', '.join(sorted(network.sees))}")
    try:
        both = kept(lambda clip: _features(network, clip))
    except InputError as error:
        return ClipFeatures(reason=error.what)
    end = both.shape[1] - len(network.labels)
    return ClipFeatures(features=both[:, :end], emotions=both[:, end:])


def _features(network: Network, clip: MotionClip) -> Array:
    """Return features and, behind them, emotions, shape (w, d + labels)."""
    opened = _opened(network.source, network.sha256)
    found = [opened.embed(clip)] + ([opened.classify(clip)] if network.labels else [])
    both = np.hstack([np.asarray(part, np.float32) for part in found])
    if not np.isfinite(both).all():
        raise InputError(
            "the network's features are not finite",
            remedy="Repair the motion, or use another network",
        )
    return both


@lru_cache(maxsize=32)
def _opened(source: Source, sha256: str) -> FeatureNetwork:
    """Return the network once per process; another content of the file is another network."""
    network = open_network(source)
    if network.sha256 != sha256:
        raise InputError(
            "the network's file changed while it was being used",
            where=source if isinstance(source, Path) else source.file,
            remedy="Leave it alone until the metrics are there",
        )
    return network
