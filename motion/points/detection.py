"""One person in a video: what MediaPipe finds of them, and which stretches of it are of use.

MediaPipe's package holds its networks.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from av.container import InputContainer
from numpy.typing import NDArray

from motion.audio import LONGEST
from motion.errors import InputError

FloatArray = NDArray[np.float64]

_BRIDGED: Final = 0.25
"""Seconds that a person may be lost for; what lies between is filled in straight."""

SHORTEST: Final = 2.0
"""Seconds below which a stretch is too short to learn from."""

_CUT: Final = 1.0
"""Widths of a face by which it moves from one frame to the next where the picture was cut."""

_CHEEKS: Final = (234, 454)
"""Landmarks of MediaPipe's face mesh on either side of a face."""

FASTEST: Final = 30.0
"""Frames per second that are looked at, of a video that has more."""

_POSE: Final = 33
_FACE: Final = 478
_REPEATED: Final = 0.5
"""Seconds for which a frame stands where the next comes late."""


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


def detect(video: Path, told: Callable[[int, int], None]) -> Detection:
    """Return where a person's body and face are in each frame of a video.

    Where several people are seen, the detector follows one of them.

    Parameters
    ----------
    video : Path
        Any file that FFmpeg reads.
    told : callable
        Told after each frame how many are done, of how many.

    Raises
    ------
    InputError
        If MediaPipe is not installed, or the file is missing, damaged or no video.
    """
    finder = _finder()
    poses: list[NDArray[np.float64]] = []
    seen: list[NDArray[np.float64]] = []
    faces: list[NDArray[np.float64]] = []
    rate = FASTEST
    lost = (np.full((_POSE, 3), np.nan), np.full(_POSE, np.nan), np.full((_FACE, 3), np.nan))
    with finder, warnings.catch_warnings():
        # MediaPipe calls what protobuf will drop one day; its version is pinned.
        warnings.filterwarnings("ignore", message="SymbolDatabase.GetPrototype")
        for rate, place, total, picture in _frames(video):
            pose, visible, face = _looked_at(finder, picture, lost)
            late = place - len(poses)
            held = (poses[-1], seen[-1], faces[-1]) if poses else lost
            for number in range(late):
                earlier = held if number < _REPEATED * rate else lost
                for kept, value in zip((poses, seen, faces), earlier, strict=True):
                    kept.append(value)
            poses.append(pose)
            seen.append(visible)
            faces.append(face)
            told(len(poses), max(total, len(poses)))
    if not poses:
        raise InputError(
            "the video has no picture", where=video, remedy="Export it again as MP4 (H.264)"
        )
    return Detection(
        frame_rate=rate,
        pose=np.stack(poses),
        visibility=np.stack(seen),
        face=np.stack(faces),
    )


def _finder() -> Any:
    try:
        from mediapipe.python.solutions.holistic import Holistic
    except ImportError as error:
        raise InputError(
            "finding people in videos needs MediaPipe",
            remedy="Install it: pip install 'motionjury[video]'",
        ) from error
    # The larger model of the pose would be fetched from elsewhere; this one is in the package.
    return Holistic(model_complexity=1, refine_face_landmarks=True)


def _looked_at(
    finder: Any, picture: NDArray[np.uint8], lost: tuple[NDArray[np.float64], ...]
) -> tuple[NDArray[np.float64], ...]:
    """Return pose, visibility and face of one picture."""
    height, width = picture.shape[:2]
    found = finder.process(picture)
    pose, visible, face = lost
    if found.pose_world_landmarks is not None:
        marks = found.pose_world_landmarks.landmark
        pose = np.array([(mark.x, mark.y, mark.z) for mark in marks])
        visible = np.array([mark.visibility for mark in marks])
    if found.face_landmarks is not None:
        marks = found.face_landmarks.landmark
        face = np.array([(mark.x * width, mark.y * height, mark.z * width) for mark in marks])
    return pose, visible, face


def _frames(video: Path) -> Iterator[tuple[float, int, int, NDArray[np.uint8]]]:
    """Yield frames a second, number of the frame, how many there will be, and picture (H, W, 3)."""
    if not video.is_file():
        raise InputError("there is no such video", where=video, remedy="Check the path")
    try:
        with av.open(str(video)) as container:
            yield from _frames_of(container, video)
    except av.FFmpegError as error:
        raise InputError(
            f"the video cannot be read ({error.strerror})",
            where=video,
            remedy="Export it again as MP4 (H.264)",
        ) from error


def _frames_of(
    container: InputContainer, video: Path
) -> Iterator[tuple[float, int, int, NDArray[np.uint8]]]:
    if not container.streams.video:
        raise InputError("the file has no picture", where=video, remedy="Give a video")
    stream = container.streams.video[0]
    stream.thread_type = "AUTO"
    rate = min(float(stream.average_rate or FASTEST), FASTEST)
    total = round((container.duration or 0) / av.time_base * rate)
    if total > LONGEST * rate:
        raise InputError(
            f"the video lasts more than {LONGEST // 3600} hours",
            where=video,
            remedy="Cut it into shorter files",
        )
    begun, last = None, -1
    for frame in container.decode(stream):
        time = float(frame.time or 0)
        begun = time if begun is None else begun
        place = round((time - begun) * rate)
        if place > last:
            last = place
            yield rate, place, total, np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)
