"""A trained feature network: clips in, embeddings out, and its file.

One safetensors file holds everything that its scores depend on.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Final, Literal, Self

import numpy as np
import torch
from pydantic import TypeAdapter
from torch import Tensor

from analysis.evaluators import feature_networks as names
from analysis.evaluators.clip_views import (
    JOINTS_OF_CHANNELS,
    TOLERANCE,
    Channels,
    ClipView,
    Face,
    cut_windows,
    long_enough,
)
from analysis.evaluators.networks import (
    AutoencoderConfig,
    AutoencoderNetwork,
    EmotionConfig,
    EmotionNetwork,
)
from motion.arrays import Floats32
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.files import sha256_of
from motion.resample import resample
from training.weights_file import read_weights, write_weights

Kind = Literal["emotion", "motion", "face"]
Network = EmotionNetwork | AutoencoderNetwork

_BATCH_SIZE: Final = 64

SHOWN_OF_HASH: Final = 16

_SEEN: Final = {
    "landmarks": "face landmarks",
    "gesture": "gestures",
    "expression": "expressions",
    "both": "gestures and expressions",
}


@dataclass(frozen=True, kw_only=True)
class EvaluatorFacts:
    """The metadata of a file: the network's input and sizes, data and training.

    Attributes
    ----------
    channels : str
        Its input.
    network : EmotionConfig or AutoencoderConfig
        Its sizes and windows.
    face : {'arkit', 'expressions'} or None
        How the face is represented, if its weights are used.
    labels : tuple of str
        The emotions it classifies; empty except for the kind ``emotion``.
    frozen : tuple of str
        Channels that are frozen in its input (`motion.clip`).
    data : mapping
        ``sha256`` of the clips, numbers of ``clips``, their ``recordings``, ``windows`` and
        ``held_out_windows``, and what was ``held_out``, in words.
    training : mapping
        Its ``config``, ``best_step`` and the ``versions`` of packages.
    held_out : mapping of str to float
        Measurements on held-out windows.
    """

    channels: Channels
    network: EmotionConfig | AutoencoderConfig
    face: Face | None
    labels: tuple[str, ...]
    frozen: tuple[str, ...]
    format: Literal[2] = 2
    data: Mapping[str, Any] = field(default_factory=dict)
    training: Mapping[str, Any] = field(default_factory=dict)
    held_out: Mapping[str, float] = field(default_factory=dict)

    @property
    def kind(self) -> Kind:
        """AMUSE's evaluator M, an autoencoder of motion, or one of face landmarks."""
        if self.channels == "body":
            return "emotion"
        return "face" if self.channels == "landmarks" else "motion"

    def view(self, landmarks: FaceLandmarks | None = None) -> ClipView:
        """Return its view of a clip; the kind ``face`` needs landmarks."""
        joints = JOINTS_OF_CHANNELS[self.channels]
        return ClipView(joints=joints, face=self.face, landmarks=landmarks)

    def fresh_network(self, channels: int) -> Network:
        """Return an untrained network for frames with this number of channels."""
        if isinstance(self.network, EmotionConfig):
            return EmotionNetwork(self.network, channels, len(self.labels))
        return AutoencoderNetwork(self.network, channels)

    def description(self) -> str:
        """Return the network in words."""
        if isinstance(self.network, EmotionConfig):
            return f"emotion classifier (AMUSE's M), {self.network.width} features"
        return f"autoencoder of {_SEEN[self.channels]}, {self.network.features} features"


_FACTS: Final = TypeAdapter(EvaluatorFacts)


@dataclass(frozen=True, kw_only=True, eq=False)
class Normalisation:
    """Mean and spread of each channel over all recorded frames.

    Attributes
    ----------
    mean, deviation : ndarray, shape (C,), float32
        In the channels' own units; no deviation is 0.
    """

    mean: Floats32
    deviation: Floats32

    @classmethod
    def of(cls, clips: Sequence[Floats32], *, floor: Floats32) -> Self:
        """Return the normalisation of frames; still channels, below `floor`, are not amplified."""
        count = sum(len(clip) for clip in clips)
        mean = sum(clip.sum(axis=0, dtype=np.float64) for clip in clips) / count
        squares = sum(((clip - mean) ** 2).sum(axis=0) for clip in clips)
        deviation = np.maximum(np.sqrt(squares / count), floor)
        return cls(mean=mean.astype(np.float32), deviation=deviation.astype(np.float32))

    def __call__(self, frames: Floats32) -> Floats32:
        """Return frames, shape (T, C), in standard deviations from the mean."""
        return np.asarray((frames - self.mean) / self.deviation, np.float32)


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
        return in_batches(self.network.embed, self._windows(clip))

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
        return in_batches(lambda rows: self.network(rows).softmax(dim=1), self._windows(clip))

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
            "trained on": f"{data['clips']} clips of {data['recordings']} recordings, "
            f"{data['windows']} windows, data sha256 {data['sha256'][:SHOWN_OF_HASH]}",
            "held out": f"{data['held_out']}: {self._held_out()}",
        }
        if facts.frozen:
            description["held still"] = ", ".join(facts.frozen)
        return description

    def _held_out(self) -> str:
        measured = self.facts.held_out
        count = f"{self.facts.data['held_out_windows']} windows"
        if self.labels:
            return (
                f"accuracy {measured['accuracy']:.3f} of {count} (always the most frequent "
                f"emotion: {measured['largest_share']:.3f})"
            )
        return (
            f"reconstruction error {measured['error']:.3f} deviations of {count} (always "
            f"the mean pose: {measured['error_of_mean']:.3f})"
        )


@torch.inference_mode()
def in_batches(network: Callable[[Tensor], Tensor], windows: Floats32) -> Floats32:
    """Return a network's output for windows, shape (n, ...), computed in batches."""
    batches = torch.split(torch.from_numpy(windows), _BATCH_SIZE)
    return np.concatenate([network(batch).numpy() for batch in batches])


def write_evaluator(path: Path, evaluator: Evaluator) -> None:
    """Write `evaluator` to `path` in one step; equal ones make equal bytes."""
    arrays = {f"normalisation.{name}": v for name, v in vars(evaluator.normalisation).items()}
    if evaluator.landmarks is not None:
        arrays |= {f"landmarks.{name}": v for name, v in evaluator.landmarks.arrays().items()}
    tensors = {f"network.{name}": v for name, v in evaluator.network.state_dict().items()}
    tensors |= {name: torch.from_numpy(array) for name, array in arrays.items()}
    write_weights(path, tensors, _FACTS.dump_python(evaluator.facts, mode="json"))


def load_evaluator(path: Path) -> Evaluator:
    """Read a feature network that ``motionjury train evaluator`` wrote.

    Raises
    ------
    InputError
        If the file is missing or damaged, or comes from another program or version.
    """
    file = read_weights(path)

    def arrays(part: str) -> dict[str, Any]:
        return {name: tensor.numpy() for name, tensor in file.with_prefix(part).items()}

    try:
        facts = _FACTS.validate_python(file.facts)
        is_face = facts.kind == "face"
        landmarks = FaceLandmarks.from_arrays(arrays("landmarks")) if is_face else None
        return Evaluator(
            facts=facts,
            network=file.loaded(facts.fresh_network(facts.view(landmarks).channels), "network"),
            normalisation=Normalisation(**arrays("normalisation")),
            landmarks=landmarks,
            sha256=sha256_of(path),
        )
    except (TypeError, ValueError, RuntimeError, AssertionError) as error:
        raise InputError(
            "the file holds weights, but not of a feature network of this version",
            where=path,
            remedy="Give a file as 'motionjury train evaluator' wrote it, or train again",
        ) from error
