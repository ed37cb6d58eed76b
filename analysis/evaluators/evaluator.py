"""A trained feature network: clips in, embeddings out, and its file.

One safetensors file holds everything that its scores depend on.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Final, Literal

import numpy as np
import torch
from pydantic import Field, ValidationError
from torch import Tensor

from analysis.evaluators import feature_networks as names
from analysis.evaluators.clip_views import TOLERANCE, ClipView, Facts, cut_windows, long_enough
from analysis.evaluators.design import Design, Network
from analysis.evaluators.examples import Normalisation
from motion.arrays import Floats32
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip, freeze
from motion.errors import InputError, found_at
from motion.files import sha256_of
from motion.resample import resample
from training.weights_file import WeightsFile, read_weights, write_weights

_BATCH_SIZE: Final = 64

SHOWN_OF_HASH: Final = 16

_FORMAT: Final = 2

_REMEDY: Final = "Give a file as 'motionjury train evaluator' wrote it, or train again"


class DataFacts(Facts):
    """The data a network was trained on.

    Attributes
    ----------
    sha256 : str
        Hash of the motion files, their recordings and emotions.
    clips, recordings : int
        Number of clips and of their recordings.
    windows, held_out_windows : int
        Windows for training, and held-out windows.
    held_out : str
        What was held out, in words.
    """

    sha256: str = Field(pattern="^[0-9a-f]{64}$")
    clips: int
    recordings: int
    windows: int
    held_out_windows: int
    held_out: str


class TrainingFacts(Facts):
    """The training of a network.

    Attributes
    ----------
    config : mapping
        `training.config.TrainingConfig`, as JSON holds it.
    best_step : int
        Step with the best weights on held-out windows, which the file holds.
    last_loss : float
        Loss of the last step.
    versions : mapping of str to str
        Versions of the packages used.
    """

    config: dict[str, Any]
    best_step: int
    last_loss: float
    versions: dict[str, str]


class EvaluatorFacts(Design):
    """The metadata of a file: the network's design, data and training.

    Attributes
    ----------
    data : DataFacts
        The data.
    training : TrainingFacts
        The training.
    held_out : mapping of str to float
        Measurements on held-out windows.
    """

    format: Literal[2] = _FORMAT
    data: DataFacts
    training: TrainingFacts
    held_out: dict[str, float]


@dataclass(frozen=True, kw_only=True, eq=False)
class Evaluator:
    """A trained feature network with everything that it needs.

    Attributes
    ----------
    facts : EvaluatorFacts
        The metadata of its file.
    network : Network
        In evaluation mode, on the processor.
    normalisation : Normalisation
        The normalisation of its channels.
    landmarks : FaceLandmarks or None
        For the kind ``face``.
    sha256 : str
        Hash of its file, which every score quotes; '' before it is written.
    rule : None
        No published code computes distances in its features.
    """

    facts: EvaluatorFacts
    network: Network
    normalisation: Normalisation
    landmarks: FaceLandmarks | None
    sha256: str = ""
    rule: ClassVar[None] = None

    @property
    def name(self) -> str:
        """A name in `analysis.evaluators.feature_networks`."""
        return names.OF_CHANNELS[self.facts.channels]

    @property
    def labels(self) -> tuple[str, ...]:
        """The emotions of `classify`, in its order; empty but for the kind ``emotion``."""
        return self.facts.labels

    @cached_property
    def _view(self) -> ClipView:
        return self.facts.view(self.landmarks)

    def embed(self, clip: MotionClip) -> Floats32:
        """Return the embedding of each window of a clip.

        Parameters
        ----------
        clip : MotionClip
            A clip at any frame rate. Channels that were frozen in training are frozen.

        Returns
        -------
        ndarray, shape (windows, d), float32
            Windows do not overlap, from the first frame on; an incomplete last one is left out.

        Raises
        ------
        InputError
            If the clip is shorter than one window, or lacks the network's input.
        """
        windows = torch.from_numpy(self._windows(clip))
        with torch.inference_mode():
            return np.asarray(in_batches(self.network.embed, windows).numpy())

    def classify(self, clip: MotionClip) -> Floats32:
        """Return the probability of each emotion in each window of a clip.

        Returns
        -------
        ndarray, shape (windows, len(labels)), float32
            Rows sum to 1.

        Raises
        ------
        InputError
            As in `embed`; or if the network classifies no emotions.
        """
        if not self.labels:
            raise InputError(
                f"a network of kind {self.facts.kind!r} classifies no emotions",
                remedy="Use one of kind emotion ('motionjury train evaluator emotion')",
            )
        windows = torch.from_numpy(self._windows(clip))
        with torch.inference_mode():
            return np.asarray(in_batches(self.network, windows).softmax(dim=1).numpy())

    def _windows(self, clip: MotionClip) -> Floats32:
        """Return the windows of a clip as the network's input, shape (n, window, channels)."""
        rate, window = self.facts.network.frame_rate, self.facts.network.window
        frames = self._view.frames(resample(freeze(clip, self.facts.frozen), rate))
        frames = long_enough(self.normalisation(frames), window, rate)
        return cut_windows(frames, window, window)

    def describe(self) -> Mapping[str, str]:
        """Return the settings that every score of this network quotes, in words."""
        facts = self.facts
        data, rate, window = facts.data, facts.network.frame_rate, facts.network.window
        description = {
            "feature network": facts.description(),
            "network sha256": self.sha256[:SHOWN_OF_HASH],
            "representation": f"{self._view.description()}, in deviations of the training frames",
            "frame rate": f"{rate:g} fps, resampled",
            "window": f"{window} frames ({window / rate:.4g} s), not overlapping; a clip that is "
            f"up to {TOLERANCE:g} s too short holds its last frame",
            "trained on": f"{data.clips} clips of {data.recordings} recordings, {data.windows} "
            f"windows, data sha256 {data.sha256[:SHOWN_OF_HASH]}",
            "held out": f"{data.held_out}: {self._held_out()}",
        }
        if facts.frozen:
            description["held still"] = ", ".join(facts.frozen)
        return description

    def _held_out(self) -> str:
        facts = self.facts
        count = f"{facts.data.held_out_windows} windows"
        if facts.kind == "emotion":
            return (
                f"accuracy {facts.held_out['accuracy']:.3f} of {count} (always the most frequent "
                f"emotion: {facts.held_out['largest_share']:.3f})"
            )
        return (
            f"reconstruction error {facts.held_out['error']:.3f} deviations of {count} (always "
            f"the mean pose: {facts.held_out['error_of_mean']:.3f})"
        )


def in_batches(network: Callable[[Tensor], Tensor], windows: Tensor) -> Tensor:
    """Return a network's output for windows, shape (n, ...), computed in batches."""
    return torch.cat([network(batch) for batch in torch.split(windows, _BATCH_SIZE)])


def write_evaluator(path: Path, evaluator: Evaluator) -> None:
    """Write `evaluator` to `path` in one step; equal ones make equal bytes."""
    tensors: dict[str, Tensor] = {
        f"network.{name}": tensor for name, tensor in evaluator.network.state_dict().items()
    }
    tensors["normalisation.mean"] = torch.from_numpy(evaluator.normalisation.mean)
    tensors["normalisation.deviation"] = torch.from_numpy(evaluator.normalisation.deviation)
    if evaluator.landmarks is not None:
        for name, array in evaluator.landmarks.arrays().items():
            tensors[f"landmarks.{name}"] = torch.from_numpy(array)
    write_weights(path, tensors, evaluator.facts.model_dump(mode="json"))


def load_evaluator(path: Path) -> Evaluator:
    """Read a feature network that ``motionjury train evaluator`` wrote.

    Raises
    ------
    InputError
        If the file is missing or damaged, or comes from another program or version.
    """
    file = read_weights(path)
    with found_at(path):
        facts = _facts(file)
        landmarks = None
        if facts.channels == "landmarks":
            arrays = {
                name: tensor.numpy() for name, tensor in file.with_prefix("landmarks").items()
            }
            landmarks = FaceLandmarks.from_arrays(arrays)
        channels = facts.view(landmarks).channels
        return Evaluator(
            facts=facts,
            network=_network(file, facts, channels),
            normalisation=_normalisation(file, channels),
            landmarks=landmarks,
            sha256=sha256_of(path),
        )


def _facts(file: WeightsFile) -> EvaluatorFacts:
    if "kind" not in file.facts:
        raise InputError("the file holds weights, but no feature network", remedy=_REMEDY)
    if file.facts.get("format") != _FORMAT:
        raise InputError(
            f"the feature network is of format {file.facts.get('format')!r}, not {_FORMAT}",
            remedy="Use the version of the program that trained it, or train again",
        )
    try:
        return EvaluatorFacts.model_validate(file.facts)
    except ValidationError as error:
        # Keys of one kind of network are unknown to the other; such errors explain nothing.
        first = min(error.errors(), key=lambda item: item["type"] == "extra_forbidden")
        key = ".".join(map(str, first["loc"]))
        raise InputError(
            f"the file's description of its network is unusable: {key}: {first['msg']}",
            remedy=_REMEDY,
        ) from error


def _network(file: WeightsFile, design: Design, channels: int) -> Network:
    network = design.fresh_network(channels)
    try:
        network.load_state_dict(file.with_prefix("network"))
    except RuntimeError as error:
        raise InputError("the weights do not fit the network's sizes", remedy=_REMEDY) from error
    return network.eval().requires_grad_(False)


def _normalisation(file: WeightsFile, channels: int) -> Normalisation:
    arrays = {name: tensor.numpy() for name, tensor in file.with_prefix("normalisation").items()}
    for name in ("mean", "deviation"):
        if name not in arrays or arrays[name].shape != (channels,):
            raise InputError(f"the {name} of the channels does not fit", remedy=_REMEDY)
    if not (arrays["deviation"] > 0).all():
        raise InputError("the deviation of a channel is not above 0", remedy=_REMEDY)
    return Normalisation(mean=arrays["mean"], deviation=arrays["deviation"])
