"""Published evaluators, loaded by path, with the input and features of their authors."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import ArrayLike
from torch import nn

from analysis.evaluators.clip_views import cut_windows
from analysis.evaluators.evaluator import SHOWN_OF_HASH, in_batches
from analysis.evaluators.published_networks import load_weights
from analysis.evaluators.published_presets import PRESETS, Preset
from analysis.metrics.frechet import Rule
from motion.arrays import Floats, Floats32
from motion.clip import MotionClip
from motion.errors import InputError
from motion.resample import resample
from training.released_weights import read_numbers

_MEAN: Final = "bvh_mean.npy"
_SPREAD: Final = "bvh_std.npy"

_REMEDY: Final = "Give bvh_mean.npy and bvh_std.npy as BEAT's authors made them"

_STILL: Final = 1e-3
"""Spread, in degrees, of channels that never move in BEAT's recordings."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PublishedEvaluator:
    """A published network with its weights.

    Attributes
    ----------
    preset : Preset
        The network.
    sha256 : str
        Hash of its file, and of BEAT's mean and spread.
    network : nn.Module
        In evaluation mode, on the processor.
    statistics : tuple of ndarray or None
        BEAT's mean and spread, shape (141,) each.
    """

    preset: Preset
    sha256: str
    network: nn.Module
    statistics: tuple[Floats, Floats] | None = None
    labels: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Its name in scores."""
        return self.preset.title

    @property
    def rule(self) -> Rule:
        """How the published code computes the Fréchet distance."""
        return self.preset.rule

    def features(self, motion: ArrayLike) -> Floats32:
        """Return the published features of motion in the network's own representation.

        Parameters
        ----------
        motion : array_like, shape (n, T, channels)
            Normalised as in the network's training; see `Preset.sees`. For BEAT and TED, `T` is the
            window; for the others it is at least `Preset.shortest`.

        Returns
        -------
        ndarray, float32
            EMAGE: (n, T // 32 * 2, 240); BEAT: (n, 300); TED: (n, 32); TalkSHOW: (n, T // 4, 64).

        Raises
        ------
        InputError
            If the array has another shape or a value that is not finite.
        """
        windows, preset = np.asarray(motion, np.float32), self.preset
        frames = windows.shape[1] if windows.ndim == 3 else 0
        fits = frames == preset.window if preset.window else frames >= preset.shortest
        if (
            not fits
            or not len(windows)
            or windows.shape[2] != preset.channels
            or not np.isfinite(windows).all()
        ):
            count = f"{preset.window}" if preset.window else f"{preset.shortest} or more"
            raise InputError(
                f"the motion has shape {windows.shape}, or a value that is not finite",
                remedy=f"Give {preset.title} (n, {count} frames, {preset.channels} numbers)",
            )
        return in_batches(self.network, windows)

    def embed(self, clip: MotionClip) -> Floats32:
        """Return one row of features for each window, or part of a window, of a clip, (w, d).

        Raises
        ------
        InputError
            If the clip is shorter than a window, or BEAT's mean and spread are missing.
        """
        preset = self.preset
        frames = self._normalised(preset.frames(resample(clip, preset.frame_rate)))
        needed = max(preset.shortest, preset.span)
        if len(frames) < needed:
            raise InputError(
                f"the clip lasts {len(frames) / preset.frame_rate:.2f} s, and {preset.title} needs "
                f"at least {needed / preset.frame_rate:.2f} s",
                remedy="Use longer clips",
            )
        if preset.window:
            windows = cut_windows(frames, preset.span, preset.stride)[:, : preset.window]
        else:
            windows = frames[None]
        return self.features(windows).reshape(-1, preset.features)

    def classify(self, clip: MotionClip) -> Floats32:
        """Raise an error: a published evaluator classifies no emotions."""
        raise InputError(
            f"{self.preset.title} classifies no emotions",
            remedy="Train a network that does ('motionjury train evaluator emotion')",
        )

    def describe(self) -> Mapping[str, str]:
        """Return the settings that every score of this network quotes, in words."""
        preset = self.preset
        return {
            "feature network": f"{preset.source}, {preset.features} features",
            "network sha256": self.sha256[:SHOWN_OF_HASH],
            "representation": preset.sees,
            "frame rate": f"{preset.frame_rate:g} fps, resampled",
            "window": preset.cut,
            "batch normalisation": "as stored (evaluation mode)",
        }

    def _normalised(self, frames: Floats) -> Floats32:
        if self.preset is not PRESETS["beat"]:
            return frames.astype(np.float32)
        if self.statistics is None:
            raise InputError(
                "BEAT's evaluator sees motion in deviations of BEAT's frames, and its mean and "
                "spread are not given",
                remedy="Put bvh_mean.npy and bvh_std.npy next to the checkpoint, or name their "
                "folder as 'statistics'",
            )
        mean, spread = self.statistics
        # Channels that never move in BEAT's recordings or have no SMPL-X joint are at their mean.
        frames = np.where(np.isnan(frames) | (spread < _STILL), mean, frames)
        return np.asarray((frames - mean) / np.maximum(spread, _STILL), np.float32)


def load_published(
    preset: str, file: Path | str, *, statistics: Path | str | None = None
) -> PublishedEvaluator:
    """Load a published evaluator from its checkpoint.

    Parameters
    ----------
    preset : str
        A name in `PRESETS`: ``emage``, ``beat``, ``ted`` or ``talkshow``.
    file : path
        The released checkpoint. Nothing that could run code is unpickled.
    statistics : path, optional
        For ``beat``: the folder with ``bvh_mean.npy`` and ``bvh_std.npy``; by default that of
        `file`. `PublishedEvaluator.features` does without them.

    Raises
    ------
    InputError
        If the preset is unknown, or the file is missing, unreadable or another network's.
    """
    if preset not in PRESETS:
        raise InputError(
            f"unknown published evaluator {preset!r}", remedy=f"Use any of {', '.join(PRESETS)}"
        )
    chosen, path = PRESETS[preset], Path(file)
    network = chosen.network()
    load_weights(network, path, chosen.place)
    digest = hashlib.sha256(path.read_bytes())
    arrays = None
    if preset == "beat":
        folder = path.parent if statistics is None else Path(statistics)
        if statistics is not None or (folder / _MEAN).exists():
            files = folder / _MEAN, folder / _SPREAD
            mean, spread = (read_numbers(each, chosen.channels, _REMEDY) for each in files)
            arrays = mean, spread
        for values in arrays or ():
            digest.update(values.tobytes())
    return PublishedEvaluator(
        preset=chosen, sha256=digest.hexdigest(), network=network, statistics=arrays
    )
