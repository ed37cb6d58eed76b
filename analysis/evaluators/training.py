"""Training a feature network on a researcher's own recordings."""

import hashlib
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor

from analysis.evaluators.clip_views import (
    JOINTS_OF_CHANNELS,
    Channels,
    ClipView,
    Face,
    face_of,
    long_enough,
)
from analysis.evaluators.evaluator import (
    Evaluator,
    EvaluatorFacts,
    Kind,
    Network,
    Normalisation,
    write_evaluator,
)
from analysis.evaluators.networks import AutoencoderConfig, EmotionConfig
from motion.arrays import Floats32, Ints
from motion.body.face_landmarks import FaceLandmarks
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.resample import resample
from motion.segment import EMOTIONS
from training.config import Preset, read_presets
from training.data.feature_cache import PreparedTakes
from training.data.splitting import held_out_recordings
from training.data.take import Take
from training.data.windows import Windows
from training.device import check_device
from training.run.launching import is_leader
from training.run.loop import Show, train
from training.run.records import RunFolder, run_facts, run_folder
from training.run.task import WindowTask

HELD_OUT_SHARE: Final = 0.2
"""Share of the recordings that are held out."""

FEWEST_WINDOWS: Final = 32
"""Fewest training windows from which a network generalises."""

FEWEST_HELD_OUT: Final = 8
"""Fewest held-out windows that show which weights are best."""

_WITH_FACE: Final[tuple[Channels, ...]] = ("expression", "both", "landmarks")

_BATCH_SIZE: Final = 64


@dataclass(frozen=True, kw_only=True)
class EvaluatorPreset(Preset):
    """Sizes and training of a feature network.

    Attributes
    ----------
    network : EmotionConfig or AutoencoderConfig
        Its sizes and windows.
    """

    network: EmotionConfig | AutoencoderConfig


PRESETS: Final = read_presets(Path(__file__).with_name("presets.toml"), dict[str, EvaluatorPreset])
"""Presets by kind and config."""

CHANNELS_OF_KIND: Final[Mapping[Kind, Channels]] = {
    "emotion": "body",
    "motion": "gesture",
    "face": "landmarks",
}
"""The default input of each kind."""


@dataclass(frozen=True, kw_only=True)
class ClipSource:
    """A clip for training.

    Attributes
    ----------
    name : str
        A unique name.
    recording : str
        The recording it is cut from; clips of one recording are held out together.
    emotion : str
        Its label; empty where unknown.
    sha256 : str
        Hash of its file.
    read : callable
        Returns the clip, or raises `InputError`.
    """

    name: str
    recording: str
    emotion: str
    sha256: str
    read: Callable[[], MotionClip]


@dataclass(frozen=True, kw_only=True)
class EvaluatorRequest:
    """A request to train a network.

    Attributes
    ----------
    channels : str
        Its input.
    preset : EvaluatorPreset
        Its sizes and training.
    changes : mapping
        Changed fields of `training.config.TrainingConfig`.
    frozen : tuple of str
        Channels frozen in every clip, in training and in use.
    landmarks : FaceLandmarks or None
        Needed by the channels ``landmarks``.
    device : {'cpu', 'cuda'}
        Device of the training.
    """

    channels: Channels
    preset: EvaluatorPreset
    changes: Mapping[str, Any]
    frozen: tuple[str, ...] = ()
    landmarks: FaceLandmarks | None = None
    device: str = "cpu"


@dataclass(frozen=True, kw_only=True, eq=False)
class FeatureTask(WindowTask):
    """The training of a feature network, which defines its own losses.

    Attributes
    ----------
    design : EvaluatorFacts
        The network.
    width : int
        Number of channels of a frame.
    training, held_out : Windows
        Windows of the feature ``frames``.
    """

    design: EvaluatorFacts
    width: int

    def network(self) -> Network:
        """Return a fresh network."""
        return self.design.fresh_network(self.width).to(self.device)

    def losses(self, network: Network, rows: Ints, name: str = "") -> Mapping[str, Tensor]:
        """Return the losses of a batch."""
        return network.losses(*self._batch(self.training, rows))

    def validation(self, network: Network) -> Mapping[str, float]:
        """Return the network's losses on held-out windows, the loss first."""
        sums: defaultdict[str, float] = defaultdict(float)
        for rows in torch.split(torch.arange(len(self.held_out)), _BATCH_SIZE):
            losses = network.losses(*self._batch(self.held_out, rows.numpy()))
            for name, value in losses.items():
                sums[name] += float(value) * len(rows)
        return {name: value / len(self.held_out) for name, value in sums.items()}

    def _batch(self, windows: Windows, rows: Ints) -> tuple[Tensor, Tensor]:
        """Return windows, (rows, window, channels), and the number of each one's emotion."""
        names = self.design.labels or ("",)
        numbers = [names.index(take.emotion) for take in windows.takes(rows)]
        return self.tensors(windows, rows)["frames"], torch.tensor(numbers, device=self.device)


def train_evaluator(
    request: EvaluatorRequest,
    sources: Sequence[ClipSource],
    out: Path,
    *,
    show_reading: Callable[[int, int], None] | None = None,
    show_training: Show | None = None,
) -> tuple[EvaluatorFacts, tuple[InputError, ...]]:
    """Train a feature network on recorded clips, and write it to `out`.

    Parameters
    ----------
    request : EvaluatorRequest
        The network.
    sources : sequence of ClipSource
        The recordings.
    out : Path
        Its file; an interrupted run beside it is resumed.
    show_reading, show_training : callable, optional
        Called with the progress.

    Returns
    -------
    facts : EvaluatorFacts
        The metadata of its file.
    skipped : tuple of InputError
        Clips that could not be used.

    Raises
    ------
    InputError
        If too few clips are usable, if they show one emotion only, or if another run is kept beside
        `out`.
    TrainingStopped
        After Ctrl-C; the state is saved.
    """
    check_device(request.device)
    if "face" in request.frozen and request.channels in _WITH_FACE:
        raise InputError(
            "the face is held still, but the network's input is the face",
            remedy="Remove 'face' from freeze in study.toml, or train on gestures",
        )
    config = request.preset.network
    training = request.preset.config_for(0, request.changes)
    face, clips, skipped = _read_clips(request, sources, show_reading)
    left_out = f"; {len(skipped)} could not be used, the first: {skipped[0]}" if skipped else ""
    emotions = {source.emotion for source, _ in clips if request.channels == "body"}
    # The emotions known everywhere come in their own order, the others by name.
    in_order = dict.fromkeys((*EMOTIONS, *sorted(emotions)))
    design = EvaluatorFacts(
        channels=request.channels,
        network=config,
        face=face,
        labels=tuple(name for name in in_order if name in emotions),
        frozen=request.frozen,
    )
    if len(design.labels) == 1:
        raise InputError(
            f"all usable clips show one emotion, {design.labels[0]!r}{left_out}",
            remedy="Give recordings of two emotions or more, or train a network of another kind",
        )
    takes, held_out = _split(clips, training.seed, labelled=bool(design.labels))
    for split, fewest, purpose in (
        ("train", FEWEST_WINDOWS, "to learn from"),
        ("validation", FEWEST_HELD_OUT, "to hold out"),
    ):
        count = sum(
            1 + (len(frames) - config.window) // config.stride
            for take, (_, frames) in zip(takes, clips, strict=True)
            if take.split == split
        )
        if count < fewest:
            raise InputError(
                f"the clips make {count} windows of {config.window / config.frame_rate:.4g} s "
                f"{purpose}, and a network needs {fewest}{left_out}",
                remedy="Give more recordings, or longer ones",
            )
    normalisation = Normalisation.of(
        [clip for take, (_, clip) in zip(takes, clips, strict=True) if take.split == "train"],
        floor=design.view(request.landmarks).floor,
    )
    prepared = PreparedTakes(
        takes=takes,
        arrays={"frames": tuple(normalisation(frames) for _, frames in clips)},
        frame_rate=config.frame_rate,
        skipped=skipped,
        sha256=_sha256_of(clips),
    )
    task = FeatureTask(
        config=config,
        weights={},
        training=Windows(prepared, split="train", frames=config.window, stride=config.stride),
        held_out=Windows(prepared, split="validation", frames=config.window, stride=config.stride),
        extra_settings={
            "channels": design.channels,
            "face": face,
            "labels": list(design.labels),
            "frozen": list(request.frozen),
            "held out": held_out,
        },
        device=request.device,
        design=design,
        width=len(normalisation.mean),
    )
    trained = train(task, training, RunFolder(run_folder(out)), show=show_training)
    run = run_facts(
        training,
        trained,
        {
            "sha256": prepared.sha256,
            "clips": len(clips),
            "recordings": len({source.recording for source, _ in clips}),
            "windows": len(task.training),
            "held_out_windows": len(task.held_out),
            "held_out": held_out,
        },
    )
    data, measured = run.pop("data"), run.pop("held_out")
    if design.labels:
        labels = Counter(
            take.emotion for take in task.held_out.takes(np.arange(len(task.held_out)))
        )
        measured["largest_share"] = max(labels.values()) / labels.total()
    facts = replace(design, data=data, training=run, held_out=measured)
    if is_leader():
        evaluator = Evaluator(
            facts=facts,
            network=trained.network.cpu(),
            normalisation=normalisation,
            landmarks=request.landmarks,
        )
        write_evaluator(out, evaluator)
    return facts, skipped


_Clip = tuple[ClipSource, Floats32]
"""A usable clip, and the network's input (T, channels) at its frame rate."""


def _read_clips(
    request: EvaluatorRequest,
    sources: Sequence[ClipSource],
    show: Callable[[int, int], None] | None,
) -> tuple[Face | None, Sequence[_Clip], tuple[InputError, ...]]:
    """Return how the first face is represented, the usable clips, and errors of the others."""
    config, face = request.preset.network, None
    clips: list[_Clip] = []
    skipped: list[InputError] = []
    for number, source in enumerate(sorted(sources, key=lambda source: source.name), start=1):
        try:
            if request.channels == "body" and not source.emotion:
                raise InputError(
                    "its emotion is not stated",
                    remedy="Name it in segments.csv with its emotion",
                )
            clip = source.read()
            if face is None and request.channels in ("expression", "both"):
                face = face_of(clip)
            view = ClipView(
                joints=JOINTS_OF_CHANNELS[request.channels],
                face=face,
                landmarks=request.landmarks,
            )
            frames = view.frames(resample(freeze(clip, request.frozen), config.frame_rate))
            clips.append((source, long_enough(frames, config.window, config.frame_rate)))
        except InputError as error:
            where = error.where or source.name
            skipped.append(InputError(error.what, where=where, remedy=error.remedy))
        if show is not None:
            show(number, len(sources))
    return face, clips, tuple(skipped)


def _split(clips: Sequence[_Clip], seed: int, *, labelled: bool) -> tuple[tuple[Take, ...], str]:
    """Hold out a fifth of the recordings of each emotion; of one recording, a fifth of the clips.

    Returns
    -------
    takes : tuple of Take
        The clips with their split; their emotion is empty unless `labelled`.
    held_out : str
        What is held out, in words.
    """
    labels = [source.emotion if labelled else "" for source, _ in clips]
    units, noun = [source.recording for source, _ in clips], "recordings"
    held_out = held_out_recordings(units, labels, share=HELD_OUT_SHARE, seed=seed)
    if not held_out:
        units, noun = [source.name for source, _ in clips], "clips"
        held_out = held_out_recordings(units, labels, share=HELD_OUT_SHARE, seed=seed)
    takes = tuple(
        Take(
            name=source.name,
            speaker="",
            emotion=label,
            split="validation" if unit in held_out else "train",
            speech=Path(source.name),
            motion=Path(source.name),
        )
        for (source, _), label, unit in zip(clips, labels, units, strict=True)
    )
    return takes, f"{len(held_out)} of {len(set(units))} {noun}"


def _sha256_of(clips: Sequence[_Clip]) -> str:
    """Return the hash of the clips' files and labels, and of the network's input."""
    digest = hashlib.sha256()
    for source, frames in clips:
        facts = (source.name, source.recording, source.emotion, source.sha256)
        digest.update(repr(facts).encode())
        digest.update(np.ascontiguousarray(frames).data)
    return digest.hexdigest()
