"""What a network is told of a take, and what it learns to give: computed once, then kept."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from training.data.take import Take

_NAME: Final = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True, kw_only=True)
class Feature:
    """Something computed from the files of a take.

    Attributes
    ----------
    name : str
        Lower-case letters, digits and '_', such as ``gesture`` or ``mel``.
    version : str
        Changes whenever what `compute` gives may change: with its code, its settings, and the
        weights of a network that it uses.
    compute : callable
        From a take to (frames, channels) float32, at least one frame. Frame k belongs to
        ``k / frame_rate`` seconds from the start of the take, at the frame rate at which the
        takes are prepared. Looks at the take's files alone. Raises `InputError` where a file is
        unusable.
    """

    name: str
    version: str
    compute: Callable[[Take], NDArray[np.float32]]

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name) or not self.version:
            raise ValueError(f"{self.name!r}, version {self.version!r}, is no feature")
