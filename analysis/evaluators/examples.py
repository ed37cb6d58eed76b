"""Windows of recorded motion for training and validation, and the training task."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor

from analysis.evaluators.clip_views import window_starts
from analysis.evaluators.design import Network
from motion.arrays import Floats32, Ints
from training.data.splitting import held_out_recordings

_BATCH_SIZE: Final = 64

HELD_OUT_SHARE: Final = 0.2
"""Share of the recordings that are held out."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Normalisation:
    """Mean and spread of each channel over all recorded frames.

    Attributes
    ----------
    mean, deviation : ndarray, shape (C,), float32
        In the channels' own units; no deviation is below its floor.
    """

    mean: Floats32
    deviation: Floats32

    @classmethod
    def of(cls, clips: Sequence[Floats32], *, floor: Floats32) -> Normalisation:
        """Return the normalisation of recorded frames.

        Parameters
        ----------
        clips : sequence of ndarray, shape (T, C)
            At least one frame in all.
        floor : ndarray, shape (C,)
            Smallest deviation of each channel, so that still channels are not amplified.
        """
        frames = sum(len(clip) for clip in clips)
        mean = sum(clip.sum(axis=0, dtype=np.float64) for clip in clips) / frames
        squares = sum(((clip - mean) ** 2).sum(axis=0) for clip in clips)
        deviation = np.maximum(np.sqrt(squares / frames), floor)
        return cls(mean=np.asarray(mean, np.float32), deviation=np.asarray(deviation, np.float32))

    def __call__(self, frames: Floats32) -> Floats32:
        """Return frames, shape (T, C), in standard deviations from the mean."""
        return np.asarray((frames - self.mean) / self.deviation, np.float32)


@dataclass(frozen=True, kw_only=True, eq=False)
class Examples:
    """Windows of normalised frames.

    Attributes
    ----------
    frames : Tensor, shape (N, C)
        The frames of all clips, one after another.
    starts : Tensor, shape (n,), int64
        First frame of each window.
    labels : Tensor, shape (n,), int64
        Index of each window's label; 0 without labels.
    window : int
        Frames of a window.
    """

    frames: Tensor
    starts: Tensor
    labels: Tensor
    window: int

    def __len__(self) -> int:
        """Return the number of windows."""
        return len(self.starts)

    def batch(self, rows: Ints) -> tuple[Tensor, Tensor]:
        """Return the windows of `rows`, shape (b, window, C), and their labels, shape (b,)."""
        index = torch.from_numpy(rows).to(self.starts.device)
        within = torch.arange(self.window, device=self.starts.device)
        return self.frames[self.starts[index][:, None] + within], self.labels[index]


@dataclass(frozen=True, kw_only=True, eq=False)
class Split:
    """All windows, in two parts.

    Attributes
    ----------
    training, held_out : Examples
        Both over the same frames.
    normalisation : Normalisation
        The normalisation of the training frames only.
    recordings : int
        Number of recordings.
    how : str
        What was held out, in words.
    """

    training: Examples
    held_out: Examples
    normalisation: Normalisation
    recordings: int
    how: str


def split(
    clips: Sequence[Floats32],
    recordings: Sequence[str],
    labels: Sequence[str],
    *,
    names: Sequence[str],
    window: int,
    stride: int,
    floor: Floats32,
    seed: int,
    device: str,
) -> Split:
    """Cut clips into windows, and hold out a fifth of the recordings of each label.

    If no label has two recordings, the last fifth of every clip is held out instead; windows across
    the border are dropped.

    Parameters
    ----------
    clips : sequence of ndarray, shape (T, C)
        Frames of each clip, at least `window` of them.
    recordings, labels : sequence of str
        The recording and the label of each clip.
    names : sequence of str
        The labels in the order of their numbers.
    window, stride : int
        Frames per window, and frames from one window to the next.
    floor : ndarray, shape (C,)
        Smallest deviation of each channel.
    seed : int
        Determines which recordings are held out.
    device : str
        Device that holds the windows.
    """
    held_out = held_out_recordings(recordings, labels, share=HELD_OUT_SHARE, seed=seed)
    total = len(set(recordings))
    training_windows, held_out_windows, training_clips = [], [], []
    offset = 0
    for clip, recording, label in zip(clips, recordings, labels, strict=True):
        starts = window_starts(len(clip), window, stride)
        number = names.index(label)
        if held_out:
            border = 0 if recording in held_out else len(clip)
        else:
            border = round((1 - HELD_OUT_SHARE) * len(clip))
        training_windows += [
            (offset + start, number) for start in starts if start + window <= border
        ]
        held_out_windows += [(offset + start, number) for start in starts if start >= border]
        training_clips.append(clip[:border])
        offset += len(clip)
    normalisation = Normalisation.of(training_clips, floor=floor)
    frames = torch.from_numpy(normalisation(np.concatenate(clips))).to(device)
    how = (
        f"{len(held_out)} of {total} recordings"
        if held_out
        else "the last fifth of every clip, since "
        + ("there is one recording" if total == 1 else "no emotion has two recordings")
    )
    return Split(
        training=_examples(frames, training_windows, window),
        held_out=_examples(frames, held_out_windows, window),
        normalisation=normalisation,
        recordings=total,
        how=how,
    )


def _examples(frames: Tensor, windows: Sequence[tuple[int, int]], window: int) -> Examples:
    table = torch.tensor(windows, dtype=torch.int64).reshape(-1, 2).to(frames.device)
    return Examples(frames=frames, starts=table[:, 0], labels=table[:, 1], window=window)


@dataclass(frozen=True, kw_only=True, eq=False)
class FeatureTask:
    """The training of a feature network, which defines its own losses.

    Attributes
    ----------
    fresh : callable
        Makes the network for a number of channels.
    training, held_out : Examples
        Windows.
    settings : mapping
        Settings that identify the task.
    data_sha256 : str
        Hash of all clips.
    device : str
        ``cpu`` or ``cuda``.
    """

    fresh: Callable[[int], Network]
    training: Examples
    held_out: Examples
    settings: Mapping[str, Any]
    data_sha256: str
    device: str = "cpu"

    @property
    def examples(self) -> int:
        """Number of training windows."""
        return len(self.training)

    def network(self) -> Network:
        """Return a fresh network."""
        return self.fresh(self.training.frames.shape[1]).to(self.device)

    def losses(self, network: Network, rows: Ints) -> Mapping[str, Tensor]:
        """Return the losses of a batch."""
        return network.losses(*self.training.batch(rows))

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return the network's measurements on held-out windows, the loss first."""
        sums: defaultdict[str, float] = defaultdict(float)
        for rows in torch.split(torch.arange(len(self.held_out)), _BATCH_SIZE):
            windows, labels = self.held_out.batch(rows.numpy())
            for name, value in network.measured(windows, labels).items():
                sums[name] += float(value) * len(windows)
        return {name: value / len(self.held_out) for name, value in sums.items()}
