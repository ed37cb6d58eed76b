"""Training a feature network on a researcher's own recordings."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import torch

from analysis.evaluators.clip_views import JOINTS_OF_CHANNELS, ClipView, Face, WindowConfig, face_of
from analysis.evaluators.design import SIZES, Design, EvaluatorRequest, Kind, Network
from analysis.evaluators.evaluator import (
    DataFacts,
    Evaluator,
    EvaluatorFacts,
    TrainingFacts,
    write_evaluator,
)
from analysis.evaluators.examples import FeatureTask, Split, split
from analysis.evaluators.training_clips import (
    ClipSource,
    TrainingClips,
    read_training_clips,
)
from motion.arrays import Floats32
from motion.clip import MotionClip, freeze
from motion.errors import InputError
from motion.resample import resample
from motion.segment import EMOTIONS
from training.device import check_device
from training.run.launching import is_leader
from training.run.loop import Show, Trained, train
from training.run.records import RunFolder, package_versions

FEWEST_WINDOWS: Final = 32
"""Fewest training windows from which a network generalises."""

FEWEST_HELD_OUT: Final = 8
"""Fewest held-out windows that show which weights are best."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TrainedEvaluator:
    """The result of a training.

    Attributes
    ----------
    facts : EvaluatorFacts
        The metadata of its file.
    skipped : tuple of InputError
        Clips that could not be used.
    """

    facts: EvaluatorFacts
    skipped: tuple[InputError, ...]


def train_evaluator(
    request: EvaluatorRequest,
    sources: Sequence[ClipSource],
    out: Path,
    folder: RunFolder,
    *,
    show_reading: Callable[[int, int], None] | None = None,
    show_training: Show | None = None,
) -> TrainedEvaluator:
    """Train a feature network on recorded clips, and write it to `out`.

    Parameters
    ----------
    request : EvaluatorRequest
        The network.
    sources : sequence of ClipSource
        The recordings.
    out : Path
        Its file.
    folder : RunFolder
        Keeps the run; an interrupted run is resumed.
    show_reading, show_training : callable, optional
        Called with the progress.

    Raises
    ------
    InputError
        If too few clips are usable, if they show one emotion only, or if `folder` keeps another
        run.
    TrainingStopped
        After Ctrl-C; the state is saved.
    """
    check_device(request.device)
    config = SIZES[request.kind][request.size]
    reader = _InputReader(request, config.frame_rate)
    clips = read_training_clips(
        sources,
        reader.read,
        window=config.window,
        frame_rate=config.frame_rate,
        needs_emotion=request.kind == "emotion",
        show=show_reading,
    )
    emotions = [source.emotion if request.kind == "emotion" else "" for source in clips.sources]
    # The emotions known everywhere come in their own order, the others by name.
    in_order = dict.fromkeys((*EMOTIONS, *sorted(emotions)))
    labels = tuple(name for name in in_order if name in emotions)
    _check_clips(clips, labels, request.kind)
    design = Design(
        kind=request.kind,
        channels=request.channels,
        network=config,
        joints=JOINTS_OF_CHANNELS[request.channels],
        face=reader.face,
        labels=labels if request.kind == "emotion" else (),
        frozen=request.frozen,
    )
    parts = split(
        clips.frames,
        [source.recording for source in clips.sources],
        emotions,
        names=labels,
        window=config.window,
        stride=config.stride,
        floor=design.view(request.landmarks).floor,
        seed=request.training.seed,
        device=request.device,
    )
    _check_windows(parts, config, clips)
    task = FeatureTask(
        fresh=design.fresh_network,
        training=parts.training,
        held_out=parts.held_out,
        settings=design.model_dump(mode="json", exclude={"network"})
        | {"device": request.device, "held out": parts.how}
        | design.network.model_dump(mode="json"),
        data_sha256=clips.seen_sha256,
        device=request.device,
    )
    trained = train(task, request.training, folder, show=show_training)
    facts = EvaluatorFacts(
        **dict(design),
        data=DataFacts(
            sha256=clips.sha256,
            clips=len(clips.sources),
            recordings=parts.recordings,
            windows=len(parts.training),
            held_out_windows=len(parts.held_out),
            held_out=parts.how,
        ),
        training=TrainingFacts(
            config=request.training.facts(),
            best_step=trained.best.step,
            last_loss=trained.last_loss,
            versions=package_versions(),
        ),
        held_out=_held_out(trained, parts, request.kind),
    )
    evaluator = Evaluator(
        facts=facts,
        network=trained.network.cpu(),
        normalisation=parts.normalisation,
        landmarks=request.landmarks,
    )
    if is_leader():
        write_evaluator(out, evaluator)
    return TrainedEvaluator(facts=facts, skipped=clips.skipped)


class _InputReader:
    """Reads the network's input from clips; the first face determines its representation."""

    def __init__(self, request: EvaluatorRequest, frame_rate: float) -> None:
        self._request = request
        self._frame_rate = frame_rate
        self.face: Face | None = None

    def read(self, clip: MotionClip) -> Floats32:
        """Return the clip's frames at the network's frame rate, shape (T, C)."""
        if self.face is None and self._request.channels in ("expression", "both"):
            self.face = face_of(clip)
        view = ClipView(
            joints=JOINTS_OF_CHANNELS[self._request.channels],
            face=self.face,
            landmarks=self._request.landmarks,
        )
        return view.frames(resample(freeze(clip, self._request.frozen), self._frame_rate))


def _check_clips(clips: TrainingClips, labels: tuple[str, ...], kind: Kind) -> None:
    """Raise an error if there is nothing to learn."""
    if not clips.sources:
        raise InputError(
            f"there is no clip to learn from{_left_out(clips)}",
            remedy="Give recordings that hold the network's input and are as long as a window",
        )
    if kind == "emotion" and len(labels) < 2:
        raise InputError(
            f"the usable clips ({len(clips.sources)}) show one emotion, {labels[0]!r}"
            f"{_left_out(clips)}",
            remedy="Give recordings of two emotions or more, or train a network of another kind",
        )


def _left_out(clips: TrainingClips) -> str:
    """Return a clause with the number of unusable clips and the first one's error."""
    if not clips.skipped:
        return ""
    count = len(clips.skipped)
    first = f"{clips.skipped[0].where}: {clips.skipped[0].what}"
    return f"; {count} could not be used ({'such as ' if count > 1 else ''}{first})"


def _check_windows(parts: Split, config: WindowConfig, clips: TrainingClips) -> None:
    """Raise an error if there are too few windows for training or for validation."""
    for count, fewest, purpose in (
        (len(parts.training), FEWEST_WINDOWS, "to learn from"),
        (len(parts.held_out), FEWEST_HELD_OUT, "to hold out"),
    ):
        if count < fewest:
            raise InputError(
                f"the clips make {count} windows of {config.seconds:.4g} s {purpose}, and a "
                f"network needs {fewest}{_left_out(clips)}",
                remedy="Give more recordings, or longer ones",
            )


def _held_out(trained: Trained[Network], parts: Split, kind: Kind) -> dict[str, float]:
    """Return the measurements on held-out windows.

    ``largest_share`` is the accuracy of always naming the most frequent emotion.
    """
    measured = dict(trained.best.measured)
    if kind == "emotion":
        counts = torch.bincount(parts.held_out.labels)
        measured["largest_share"] = int(counts.max()) / len(parts.held_out)
    return measured
