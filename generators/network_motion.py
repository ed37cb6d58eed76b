"""Motion that a network tells part by part, and what its clips say of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from generators.interface import OnPart
from generators.settings import ModelSettings
from motion.errors import InputError


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
