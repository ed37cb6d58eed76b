"""Features of clips from a network: computed once per clip and network, and kept on disk."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators.feature_networks import FeatureNetwork, Network, Source, open_network
from analysis.measurement.kept_arrays import KeptArrays
from analysis.measurement.seen_motion import SeenMotion
from motion.errors import InputError

Array = NDArray[np.float32]

VERSION: Final = "1"
"""Raised whenever the same network gives other features of the same motion file."""


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
    kept : Path or None
        Where the features are kept.
    """

    features: Array = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    emotions: Array = field(default_factory=lambda: np.zeros((0, 0), np.float32))
    reason: str = ""
    kept: Path | None = None

    @property
    def named(self) -> int | None:
        """Which emotion the clip is taken for, by the mean over its windows; None without."""
        return int(self.emotions.mean(axis=0).argmax()) if self.emotions.size else None


@dataclass(frozen=True, kw_only=True)
class FeaturesOf:
    """Looks at motion files with one network; it travels to other processes.

    Attributes
    ----------
    network : Network
        With which.
    motion : SeenMotion
        How the files are read.
    folder : Path or None
        Where features are kept between runs.
    """

    network: Network
    motion: SeenMotion
    folder: Path | None

    def __call__(self, path: Path) -> ClipFeatures:
        """Return the features of the motion file `path`, or why it has none."""
        try:
            return self._features(path)
        except InputError as error:
            return ClipFeatures(reason=error.what)

    def forget_others(self, used: set[Path]) -> None:
        """Remove features of this network that are kept but not `used`."""
        if self.folder is not None:
            _kept(self.folder).forget(self._settings, used)

    def _features(self, path: Path) -> ClipFeatures:
        labels = len(self.network.labels)
        place = None
        if self.folder is not None:
            place = _kept(self.folder).place(path, self._settings)
            found = KeptArrays.read(place, (None, None))
            if found is not None and found.shape[1] > labels:
                return _split(found, labels, place)
        clip = self.motion.read(path)
        network = _opened(self.network.source, self.network.sha256)
        both = np.asarray(network.embed(clip), np.float32)
        if labels:
            both = np.hstack([both, np.asarray(network.classify(clip), np.float32)])
        if not np.isfinite(both).all():
            raise InputError(
                "the network's features are not finite",
                where=path,
                remedy="Repair the motion, or use another network",
            )
        if place is not None:
            KeptArrays.keep(place, both)
        return _split(both, labels, place)

    @property
    def _settings(self) -> str:
        return f"{self.network.sha256} {self.motion}"


def _split(both: Array, labels: int, place: Path | None) -> ClipFeatures:
    end = both.shape[1] - labels
    return ClipFeatures(features=both[:, :end], emotions=both[:, end:], kept=place)


@lru_cache(maxsize=8)
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


@lru_cache(maxsize=8)
def _kept(folder: Path) -> KeptArrays:
    return KeptArrays(folder, "features", VERSION)
