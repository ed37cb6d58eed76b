"""What generators have in common whose motion a network tells, and what their clips say of it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import ClassVar, Final, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from generators.clip_length import with_length
from generators.interface import OnPart, SpeechSegment, StudyClips, seeded_stream, unheard
from generators.settings import ModelSettings
from motion.clip import MotionClip, check_frame_rate
from motion.errors import InputError
from motion.resample import resample
from training.device import check_device

Given = TypeVar("Given", bound=ModelSettings)


class NetworkGenerator(ABC, Generic[Given]):
    """A generator whose motion a network tells at a frame rate of its own.

    Parameters
    ----------
    settings : ModelSettings
        Checkpoint and what belongs to it. Networks are read when the first clip is made.
    device : {'cpu', 'cuda'}
        Where they run.

    Raises
    ------
    InputError
        If the device is not usable.
    """

    name: ClassVar[str]
    version: ClassVar[str]
    needs_source: Final = False

    def __init__(self, settings: Given, device: str = "cpu") -> None:
        check_device(device)
        self._settings = settings
        self._device = device

    def generate(
        self,
        speech: SpeechSegment,
        *,
        seed: int,
        frame_rate: float,
        source: StudyClips | None = None,
        on_part: OnPart = unheard,
    ) -> MotionClip:
        """Return motion to `speech`; see `generators.interface.Generator.generate`.

        It is made at the network's frame rate and resampled; its provenance further holds what
        `made` says.
        """
        seeded_stream(seed)
        count = speech.frame_count(frame_rate)
        check_frame_rate(frame_rate)
        clip, facts = self.made(speech, seed, on_part)
        return with_length(resample(clip, frame_rate), count).with_provenance(
            generator=self.name, seed=str(seed), segment=speech.segment.name, **facts
        )

    @abstractmethod
    def made(
        self, speech: SpeechSegment, seed: int, on_part: OnPart
    ) -> tuple[MotionClip, dict[str, str]]:
        """Return motion at the network's frame rate, and what its provenance further holds."""


def check_finite(motion: NDArray[np.float64], checkpoint: Path) -> None:
    """Check what a network told.

    Raises
    ------
    InputError
        If a value is not finite.
    """
    if not np.isfinite(motion).all():
        raise InputError(
            "the network tells motion that is not finite",
            where=checkpoint,
            remedy="Its training has diverged: give another checkpoint",
        )


def joined(
    parts: Iterable[NDArray[np.float64]], frames: int, on_part: OnPart
) -> NDArray[np.float64]:
    """Return parts (some frames, values) one after the other, telling of how many `frames`."""
    found: list[NDArray[np.float64]] = []
    made = 0
    for part in parts:
        found.append(part)
        made += len(part)
        on_part(made, frames)
    return np.concatenate(found)


def network_facts(
    settings: ModelSettings,
    device: str,
    *,
    frames: int,
    overlap: int,
    frame_rate: float,
    stand_ins: Sequence[str] = (),
) -> dict[str, str]:
    """Return what provenance says of any network: its file, how its windows lie, what stood in."""
    facts = {
        "window_frames": str(frames),
        "window_overlap": str(overlap),
        "window_frame_rate": f"{frame_rate:g}",
        "device": device,
        "checkpoint": settings.checkpoint.name,
        "checkpoint_sha256": settings.checkpoint_sha256,
    }
    return facts | ({"stand_ins": "; ".join(stand_ins)} if stand_ins else {})
