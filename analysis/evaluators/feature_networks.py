"""Feature networks for metrics: names of networks and scores, and the features of a clip.

Papers use one name for distances in different features, so each name includes the network.
"""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from analysis.metrics.frechet import Rule
from motion.arrays import Floats32
from motion.clip import MotionClip
from motion.errors import InputError

if TYPE_CHECKING:
    from analysis.evaluators.evaluator import Evaluator
    from analysis.evaluators.published import PublishedEvaluator

EMOTION: Final = "emotion network"
GESTURE: Final = "gesture autoencoder"
EXPRESSION: Final = "expression autoencoder"
WHOLE: Final = "autoencoder of gesture and expression"
LANDMARKS: Final = "landmark autoencoder"

PUBLISHED: Final = {
    "emage": "EMAGE's evaluator",
    "beat": "BEAT's evaluator",
    "ted": "TED's evaluator",
    "talkshow": "TalkSHOW's evaluator",
}
"""The published networks that `analysis.evaluators` loads, by preset."""

FGD_OF_EMOTION: Final = f"FGD ({EMOTION})"
FGD: Final = f"FGD ({GESTURE})"
FED: Final = f"FED ({EXPRESSION})"
FMD: Final = f"FMD ({WHOLE})"
FLD: Final = f"FLD ({LANDMARKS})"
VARIANCE_OF_EMOTION: Final = f"variance of features ({EMOTION})"
EMOTION_ACCURACY: Final = f"gesture emotion accuracy ({EMOTION})"

_TRAINED: Final = (
    ("body", EMOTION, FGD_OF_EMOTION, "emotion"),
    ("gesture", GESTURE, FGD, "motion"),
    ("expression", EXPRESSION, FED, "motion --channels expression"),
    ("both", WHOLE, FMD, "motion --channels both"),
    ("landmarks", LANDMARKS, FLD, "face"),
)
"""The input, name, Fréchet distance and command of each network that is trained here."""

OF_CHANNELS: Final = {channels: network for channels, network, _, _ in _TRAINED}
"""The networks that are trained here, by their input."""

DISTANCES: Final = {
    **{network: distance for _, network, distance, _ in _TRAINED},
    **{name: f"FGD ({name})" for name in PUBLISHED.values()},
}
"""The Fréchet distance in the features of each network."""

COMMANDS: Final = {
    network: f"motionjury train evaluator {arguments}" for _, network, _, arguments in _TRAINED
}
"""The commands that train networks, by name."""


def distance_of(network: str) -> str:
    """Return the name of the Fréchet distance in the features of a network."""
    kind, _, number = network.partition(", ")
    return DISTANCES[kind].replace(kind, network) if number else DISTANCES[kind]


def extrapolated(distance: str) -> str:
    """Return the name of a Fréchet distance extrapolated to infinitely many samples."""
    return distance.replace(" (", "∞ (", 1)


def as_published(distance: str) -> str:
    """Return the name of a Fréchet distance by the published code's rule."""
    return distance.replace(" (", " by the published rule (", 1)


def kernel_of(network: str) -> str:
    """Return the name of the kernel distance in the features of a network."""
    return f"kernel distance (KID, {network})"


_FACE_NETWORKS: Final = (EXPRESSION, LANDMARKS)
"""Networks that see only the face."""


@dataclass(frozen=True, kw_only=True)
class PublishedFile:
    """A published network's checkpoint.

    Attributes
    ----------
    preset : str
        The network; a key of `PUBLISHED`.
    file : Path
        Its checkpoint.
    statistics : Path or None
        For ``beat``, the folder with its mean and spread; None for the checkpoint's folder.
    """

    preset: str
    file: Path
    statistics: Path | None = None


Source = Path | PublishedFile
"""A network's file, from ``motionjury train evaluator`` or published."""


@dataclass(frozen=True, kw_only=True)
class Network:
    """One of the feature networks of a run.

    Attributes
    ----------
    source : Path or PublishedFile
        Its file.
    sha256 : str
        Hash of the file.
    name : str
        A name of `DISTANCES`, with the start of the hash if there are several
        networks of one kind.
    settings : mapping of str to str
        Quoted by every score.
    labels : tuple of str
        Emotions that it classifies; none for other kinds.
    sees : frozenset of str
        Channels (`motion.clip`) that it depends on: if a study freezes all of them, it measures
        nothing.
    rule : {'pytorch-fid', 'offset'} or None
        The rule by which published code computes distances (`analysis.metrics.frechet`); None for
        networks trained here.
    """

    source: Source
    sha256: str
    name: str
    settings: Mapping[str, str]
    labels: tuple[str, ...] = ()
    sees: frozenset[str] = frozenset()
    rule: Rule | None = None


def open_network(source: Source) -> Evaluator | PublishedEvaluator:
    """Return the network of a file.

    In a child process torch uses one thread, because the processes share the processors.

    Raises
    ------
    InputError
        If the file holds no feature network.
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
    """Return the networks in files; the same file counts once.

    Raises
    ------
    InputError
        If a file holds no feature network.
    """
    opened: dict[str, tuple[Source, Evaluator | PublishedEvaluator]] = {}
    for source in sources:
        network = open_network(source)
        opened.setdefault(network.sha256, (source, network))
    kinds = Counter(network.name for _, network in opened.values())
    return tuple(
        Network(
            source=source,
            sha256=sha256,
            name=network.name + (f", {sha256[:8]}" if kinds[network.name] > 1 else ""),
            settings=network.describe(),
            labels=network.labels,
            sees=frozenset({"face"} if network.name in _FACE_NETWORKS else ()),
            rule=network.rule,
        )
        for sha256, (source, network) in opened.items()
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class ClipFeatures:
    """A network's features of one clip.

    Attributes
    ----------
    features : ndarray, shape (w, d), float32
        One row per window of the clip; no row if there is a `reason`.
    emotions : ndarray, shape (w, labels), float32
        Probability of each emotion; no column for networks that classify none.
    reason : str
        Why there are no features; empty if there are some.
    """

    features: Floats32 = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    emotions: Floats32 = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    reason: str = ""

    @property
    def named_emotion(self) -> int | None:
        """Index of the emotion with the highest mean probability; None without emotions."""
        return int(self.emotions.mean(axis=0).argmax()) if self.emotions.size else None


def clip_features(
    network: Network,
    frozen: tuple[str, ...],
    kept: Callable[[Callable[[MotionClip], Floats32]], Floats32],
) -> ClipFeatures:
    """Return a network's features of one clip, or why there are none.

    Parameters
    ----------
    network : Network
        The network.
    frozen : tuple of str
        Channels that the study keeps still.
    kept : callable
        Returns the array that a function computes from the clip, or the kept one.
    """
    if network.sees and network.sees <= set(frozen):
        return ClipFeatures(reason=f"the study holds still: {', '.join(sorted(network.sees))}")
    try:
        array = kept(lambda clip: _features(network, clip))
    except InputError as error:
        return ClipFeatures(reason=error.what)
    end = array.shape[1] - len(network.labels)
    return ClipFeatures(features=array[:, :end], emotions=array[:, end:])


def _features(network: Network, clip: MotionClip) -> Floats32:
    """Return features followed by emotions, shape (w, d + labels)."""
    opened = _opened(network.source, network.sha256)
    parts = [opened.embed(clip)] + ([opened.classify(clip)] if network.labels else [])
    array = np.hstack([np.asarray(part, np.float32) for part in parts])
    if not np.isfinite(array).all():
        raise InputError(
            "the network's features are not finite",
            remedy="Repair the motion, or use another network",
        )
    return array


@lru_cache(maxsize=32)
def _opened(source: Source, sha256: str) -> Evaluator | PublishedEvaluator:
    """Return the network, loaded once per process and content of its file."""
    network = open_network(source)
    if network.sha256 != sha256:
        raise InputError(
            "the network's file changed while it was being used",
            where=source if isinstance(source, Path) else source.file,
            remedy="Do not change it until the metrics are computed",
        )
    return network
