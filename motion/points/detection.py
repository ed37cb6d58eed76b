"""What a detector found of one person in a video, and which stretches of it are of use."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_BRIDGED: Final = 0.25
"""Seconds that a person may be lost for; what lies between is filled in straight."""

SHORTEST: Final = 2.0
"""Seconds below which a stretch is too short to learn from."""

_CUT: Final = 1.0
"""Widths of a face by which it moves from one frame to the next where the picture was cut."""

_CHEEKS: Final = (234, 454)
"""Landmarks of MediaPipe's face mesh on either side of a face."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Detection:
    """Points of one person in the frames of a video; not a number where nobody was found.

    Attributes
    ----------
    frame_rate : float
        Frames per second.
    pose : ndarray, shape (T, 33, 3)
        MediaPipe's world landmarks of the pose, metres, y down.
    visibility : ndarray, shape (T, 33)
        From 0 to 1, how likely each is seen.
    face : ndarray, shape (T, 478, 3)
        MediaPipe's face mesh with irises, pixels, y down.
    """

    frame_rate: float
    pose: FloatArray
    visibility: FloatArray
    face: FloatArray

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.pose)

    def stretch(self, start: int, end: int) -> Detection:
        """Return the frames from `start` to before `end`, with gaps filled in straight."""
        return Detection(
            frame_rate=self.frame_rate,
            pose=_filled(self.pose[start:end]),
            visibility=_filled(self.visibility[start:end]),
            face=_filled(self.face[start:end]),
        )


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """Frames of a video, and why they are left out; an empty reason where they are of use."""

    start: int
    end: int
    reason: str


def stretches(found: Detection) -> tuple[Stretch, ...]:
    """Divide a video into stretches of one person in view, and those that are left out.

    A person who is lost for a quarter of a second is still there. A cut ends a stretch.
    """
    body = np.isfinite(found.pose[:, 0, 0])
    face = np.isfinite(found.face[:, 0, 0])
    reasons = np.select([~body, ~face], ["nobody was found", "no face was found"], "")
    _bridge(reasons, round(_BRIDGED * found.frame_rate))
    changes = np.flatnonzero(reasons[1:] != reasons[:-1]) + 1
    bounds = sorted({0, len(found), *changes.tolist(), *_cuts(found)})
    divided = [
        Stretch(start=start, end=end, reason=str(reasons[start])) for start, end in pairwise(bounds)
    ]
    least = SHORTEST * found.frame_rate
    return tuple(
        Stretch(start=one.start, end=one.end, reason=f"shorter than {SHORTEST:g} s")
        if not one.reason and one.end - one.start < least
        else one
        for one in divided
    )


def _bridge(reasons: NDArray[np.str_], longest: int) -> None:
    """Take away the reasons of short gaps that lie between frames of use."""
    useful = np.flatnonzero(reasons == "")
    for before, after in pairwise(useful):
        if after - before - 1 <= longest:
            reasons[before:after] = ""


def _cuts(found: Detection) -> list[int]:
    """Return the frames in which a face is suddenly elsewhere."""
    seen = np.flatnonzero(np.isfinite(found.face[:, 0, 0]))
    if len(seen) < 2:
        return []
    sides = found.face[seen][:, list(_CHEEKS), :2]
    width = np.linalg.norm(sides[:, 0] - sides[:, 1], axis=1)
    moved = np.linalg.norm(np.diff(sides.mean(axis=1), axis=0), axis=1)
    sudden = moved > _CUT * np.maximum(width[1:], width[:-1])
    return [int(frame) for frame in seen[1:][sudden & (np.diff(seen) == 1)]]


def _filled(values: FloatArray) -> FloatArray:
    """Return `values`, shape (T, …), with lost frames filled in from those around them."""
    flat = values.reshape(len(values), -1)
    known = np.isfinite(flat).all(axis=1)
    if known.all():
        return values
    frames = np.arange(len(values))
    columns = [np.interp(frames, frames[known], column[known]) for column in flat.T]
    return np.stack(columns, axis=1).reshape(values.shape)
