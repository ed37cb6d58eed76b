"""How unlike the pictures of two videos are."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from numpy.typing import NDArray

WIDTH: Final = 64
"""Pixels to which pictures are made smaller: grain and the encoder's traces go, limbs stay."""

EVERY: Final = 0.2
"""Seconds between two pictures that are looked at."""


@dataclass(frozen=True, eq=False)
class Pictures:
    """Small grey pictures of a video.

    Attributes
    ----------
    grey : ndarray, shape (N, H, W), float32
        0 (black) to 255.
    """

    grey: NDArray[np.float32]

    def unlike(self, other: Pictures) -> float:
        """Return the mean difference of grey where most differs, as far as both last.

        A limb covers a small part of the picture: of each pair of pictures, the tenth of the
        pixels that differ most is counted.
        """
        both = min(len(self.grey), len(other.grey))
        if both == 0 or self.grey.shape[1:] != other.grey.shape[1:]:
            return 255.0
        apart = np.abs(self.grey[:both] - other.grey[:both]).reshape(both, -1)
        most = max(1, apart.shape[1] // 10)
        return float(np.partition(apart, -most, axis=1)[:, -most:].mean())


def pictures_of(video: Path) -> Pictures | None:
    """Return small pictures of a video; None where it cannot be decoded."""
    grey: list[NDArray[np.float32]] = []
    try:
        with av.open(str(video)) as container:
            if not container.streams.video:
                return None
            stream: Any = container.streams.video[0]
            height = max(2, round(WIDTH * stream.height / stream.width / 2) * 2)
            for frame in container.decode(stream):
                if frame.time is None or frame.time + 1e-6 < len(grey) * EVERY:
                    continue
                small = frame.reformat(width=WIDTH, height=height, format="gray")
                grey.append(small.to_ndarray().astype(np.float32))
    except (av.FFmpegError, OSError):
        return None
    return Pictures(np.stack(grey)) if grey else None
