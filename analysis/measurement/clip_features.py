"""Features of clips from a network."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from analysis.evaluators.feature_networks import FeatureNetwork, Network, Source, open_network
from analysis.measurement.kept_arrays import Kind
from motion.clip import MotionClip
from motion.errors import InputError

Array = NDArray[np.float32]

FEATURES: Final = Kind("features", "1", (None, None))


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
