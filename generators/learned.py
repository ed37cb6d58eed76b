"""Code shared by learned generators: training their networks, and generating motion with them."""

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Generic, TypedDict, TypeVar

import numpy as np
from torch import nn

from generators.interface import ClipRequest, Generator, OnPart, SpeechSegment, with_length
from generators.learned_settings import ModelSettings
from generators.registry import TrainedGenerator, TrainingRequest
from motion.arrays import Floats
from motion.clip import MotionClip
from motion.errors import InputError
from motion.resample import resample
from training.config import TrainingConfig
from training.data.feature_cache import prepare
from training.data.take import Feature
from training.data.windows import Windows
from training.device import check_device
from training.run.loop import Trained, train
from training.run.records import RunFolder, run_facts, run_folder
from training.run.task import Task, WindowTask

SettingsT = TypeVar("SettingsT", bound=ModelSettings)

Network = TypeVar("Network", bound=nn.Module)


class NetworkGenerator(Generator, Generic[SettingsT]):
    """A generator whose network has its own frame rate.

    Parameters
    ----------
    settings : ModelSettings
        The checkpoint and the generator's other settings. Networks are read for the first clip.
    device : {'cpu', 'cuda'}
        Device of the networks.

    Raises
    ------
    InputError
        If the device is not usable.
    """

    def __init__(self, settings: SettingsT, device: str = "cpu") -> None:
        check_device(device)
        self._settings = settings
        self._device = device

    def make_clip(self, request: ClipRequest) -> MotionClip:
        """Return motion, made at the network's frame rate and resampled, with its facts."""
        count = request.frames
        clip, facts = self.make_motion(request.speech, request.seed, request.on_part)
        return with_length(resample(clip, request.frame_rate), count).with_provenance(**facts)

    @abstractmethod
    def make_motion(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion at the network's frame rate, and further facts for its provenance."""


def check_finite(motion: Floats, checkpoint: Path) -> None:
    """Check a network's motion.

    Raises
    ------
    InputError
        If a value is not finite.
    """
    if not np.isfinite(motion).all():
        raise InputError(
            "the network's motion is not finite",
            where=checkpoint,
            remedy="Its training has diverged: give another checkpoint",
        )


def concatenate_parts(parts: Iterable[Floats], frames: int, on_part: OnPart) -> Floats:
    """Concatenate parts (some frames, values); report the progress towards `frames`."""
    finished: list[Floats] = []
    done = 0
    for part in parts:
        finished.append(part)
        done += len(part)
        on_part(done, frames)
    return np.concatenate(finished)


def network_provenance(
    settings: ModelSettings,
    device: str,
    *,
    frames: int,
    overlap: int,
    frame_rate: float,
    stand_ins: Sequence[str] = (),
) -> dict[str, str]:
    """Return the facts of any network's provenance: its file, its windows and its stand-ins."""
    facts = {
        "window_frames": str(frames),
        "window_overlap": str(overlap),
        "window_frame_rate": f"{frame_rate:g}",
        "device": device,
        "checkpoint": settings.checkpoint.name,
        "checkpoint_sha256": settings.checkpoint_sha256,
    }
    return facts | ({"stand_ins": "; ".join(stand_ins)} if stand_ins else {})


class TrainingWindows(TypedDict):
    """The windows and the device of a `training.run.task.WindowTask`."""

    training: Windows
    held_out: Windows
    device: str


def cut_windows(
    request: TrainingRequest,
    features: Sequence[Feature],
    frame_rate: float,
    frames: int,
    stride: int,
    *,
    held_out: int | None = None,
) -> TrainingWindows:
    """Return windows of the request's recordings with their features.

    Training windows start `stride` frames apart; held-out windows start `held_out` frames apart, or
    do not overlap by default.

    Raises
    ------
    InputError
        If the device is not usable, or no recording for training or for validation is.
    """
    check_device(request.device)
    prepared = prepare(
        request.takes, features, request.cache, frame_rate=frame_rate, show=request.show_preparing
    )
    return {
        "training": Windows(prepared, split="train", frames=frames, stride=stride),
        "held_out": Windows(prepared, split="validation", frames=frames, stride=held_out or frames),
        "device": request.device,
    }


def run_training(
    request: TrainingRequest, task: Task[Network], config: TrainingConfig
) -> tuple[Trained[Network], dict[str, Any]]:
    """Train a network; return it, and the facts for its file."""
    trained = train(task, config, RunFolder(run_folder(request.out)), show=request.show_training)
    data = {"kind": request.takes.kind, "sha256": task.data_sha256}
    facts = run_facts(config, trained, data)
    return trained, {**facts, "ablation": request.choices.get("ablation")}


def describe_training(
    task: WindowTask, trained: Trained[Any], *sentences: str, warnings: Sequence[str] = ()
) -> TrainedGenerator:
    """Return the result of a training: its data, further sentences, and the kept weights."""
    takes = [take for take in task.training.prepared.takes if take.split == "train"]
    speakers = sorted({take.speaker for take in takes})
    return TrainedGenerator(
        sentences=(
            f"Learned from {len(task.training)} windows of {len(takes)} takes by {len(speakers)} "
            f"speaker{'s' * (len(speakers) != 1)} ({', '.join(speakers)}).",
            *sentences,
            f"Its weights are those of step {trained.best.step} of {trained.steps}.",
        ),
        skipped=task.training.prepared.skipped,
        warnings=tuple(warnings),
    )
