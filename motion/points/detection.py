"""Detecting one person in a video with MediaPipe, and the stretches that are usable."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats
from motion.errors import InputError

_LONGEST_GAP: Final = 0.25
"""Longest gap in seconds that is filled by linear interpolation."""

SHORTEST: Final = 2.0
"""Shortest stretch that is used for training, in seconds."""

_CUT_SHIFT: Final = 1.0
"""Movement of a face from one frame to the next, in face widths, that means a cut."""

_CHEEKS: Final = (234, 454)
"""Landmarks of MediaPipe's face mesh on either side of a face."""

FASTEST: Final = 30.0
"""Highest frame rate at which a video is analysed."""

_POSE: Final = 33
_FACE: Final = 478
_LONGEST_REPETITION: Final = 0.5
"""Seconds for which a frame is repeated if the next one is late."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Detection:
    """Points of one person in the frames of a video; NaN where no person was found.

    Attributes
    ----------
    frame_rate : float
        Frames per second.
    pose : ndarray, shape (T, 33, 3)
        MediaPipe's world landmarks of the pose, metres, y down.
    visibility : ndarray, shape (T, 33)
        Probability that each landmark is visible, in [0, 1].
    face : ndarray, shape (T, 478, 3)
        MediaPipe's face mesh with irises, pixels, y down.
    """

    frame_rate: float
    pose: Floats
    visibility: Floats
    face: Floats

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.pose)

    def stretch(self, start: int, end: int) -> Detection:
        """Return frames `start` to `end` (exclusive), with gaps interpolated linearly."""
        return Detection(
            frame_rate=self.frame_rate,
            pose=_filled(self.pose[start:end]),
            visibility=_filled(self.visibility[start:end]),
            face=_filled(self.face[start:end]),
        )


@dataclass(frozen=True, kw_only=True)
class Stretch:
    """Frames of a video, and the reason why they are unusable; empty if they are usable."""

    start: int
    end: int
    reason: str


def stretches(detection: Detection) -> tuple[Stretch, ...]:
    """Divide a video into usable and unusable stretches.

    Gaps of up to a quarter of a second do not end a stretch. A cut ends a stretch.
    """
    body = np.isfinite(detection.pose[:, 0, 0])
    face = np.isfinite(detection.face[:, 0, 0])
    reasons = np.select([~body, ~face], ["nobody was found", "no face was found"], "")
    _bridge(reasons, round(_LONGEST_GAP * detection.frame_rate))
    changes = np.flatnonzero(reasons[1:] != reasons[:-1]) + 1
    bounds = sorted({0, len(detection), *changes.tolist(), *_cuts(detection)})
    fewest = SHORTEST * detection.frame_rate
    result = []
    for start, end in pairwise(bounds):
        reason = str(reasons[start])
        if not reason and end - start < fewest:
            reason = f"shorter than {SHORTEST:g} s"
        result.append(Stretch(start=start, end=end, reason=reason))
    return tuple(result)


def _bridge(reasons: NDArray[np.str_], longest: int) -> None:
    """Clear the reasons of short gaps between usable frames."""
    useful = np.flatnonzero(reasons == "")
    for before, after in pairwise(useful):
        if after - before - 1 <= longest:
            reasons[before:after] = ""


def _cuts(detection: Detection) -> list[int]:
    """Return the frames at which a face jumps."""
    frames_with_face = np.flatnonzero(np.isfinite(detection.face[:, 0, 0]))
    if len(frames_with_face) < 2:
        return []
    sides = detection.face[frames_with_face][:, list(_CHEEKS), :2]
    width = np.linalg.norm(sides[:, 0] - sides[:, 1], axis=1)
    shifts = np.linalg.norm(np.diff(sides.mean(axis=1), axis=0), axis=1)
    sudden = shifts > _CUT_SHIFT * np.maximum(width[1:], width[:-1])
    return [int(frame) for frame in frames_with_face[1:][sudden & (np.diff(frames_with_face) == 1)]]


def _filled(values: Floats) -> Floats:
    """Return `values`, shape (T, …), with missing frames interpolated."""
    flat = values.reshape(len(values), -1)
    is_known = np.isfinite(flat).all(axis=1)
    if is_known.all():
        return values
    frames = np.arange(len(values))
    columns = [np.interp(frames, frames[is_known], column[is_known]) for column in flat.T]
    return np.stack(columns, axis=1).reshape(values.shape)


def detect(video: Path, on_frame: Callable[[int, int], None]) -> Detection:
    """Detect a person's body and face in each frame of a video.

    If several people are visible, the detector follows one of them.

    Parameters
    ----------
    video : Path
        Any file that FFmpeg reads.
    on_frame : callable
        Called after each frame with the number of frames done and their total.

    Raises
    ------
    InputError
        If MediaPipe is not installed, or the file is missing, damaged or not a video.
    """
    detector = _detector()
    found: list[tuple[Floats, ...]] = []
    rate = FASTEST
    missing = (np.full((_POSE, 3), np.nan), np.full(_POSE, np.nan), np.full((_FACE, 3), np.nan))
    with detector, warnings.catch_warnings():
        # MediaPipe uses a deprecated function of protobuf, whose version is pinned.
        warnings.filterwarnings("ignore", message="SymbolDatabase.GetPrototype")
        for rate, place, total, picture in _frames(video):
            latest = found[-1] if found else missing
            for number in range(place - len(found)):
                found.append(latest if number < _LONGEST_REPETITION * rate else missing)
            found.append(_detect_picture(detector, picture, missing))
            on_frame(len(found), max(total, len(found)))
    if not found:
        raise InputError(
            "the video has no picture", where=video, remedy="Export it again as MP4 (H.264)"
        )
    pose, visibility, face = (np.stack(points) for points in zip(*found, strict=True))
    return Detection(frame_rate=rate, pose=pose, visibility=visibility, face=face)


def _detector() -> Any:
    try:
        from mediapipe.python.solutions.holistic import Holistic
    except ImportError as error:
        raise InputError(
            "detecting people in videos needs MediaPipe",
            remedy="Install it: pip install 'motionjury[video]'",
        ) from error
    # The larger pose model would be downloaded; this one is in the package.
    return Holistic(model_complexity=1, refine_face_landmarks=True)


def _detect_picture(
    detector: Any, picture: NDArray[np.uint8], missing: tuple[Floats, ...]
) -> tuple[Floats, ...]:
    """Return pose, visibility and face of one picture."""
    height, width = picture.shape[:2]
    result = detector.process(picture)
    pose, visible, face = missing
    if result.pose_world_landmarks is not None:
        marks = result.pose_world_landmarks.landmark
        pose = np.array([(mark.x, mark.y, mark.z) for mark in marks])
        visible = np.array([mark.visibility for mark in marks])
    if result.face_landmarks is not None:
        marks = result.face_landmarks.landmark
        face = np.array([(mark.x * width, mark.y * height, mark.z * width) for mark in marks])
    return pose, visible, face


def _frames(video: Path) -> Iterator[tuple[float, int, int, NDArray[np.uint8]]]:
    """Yield frame rate, index of the frame, number of frames, and picture (H, W, 3)."""
    if not video.is_file():
        raise InputError("there is no such video", where=video, remedy="Check the path")
    start, last = None, -1
    try:
        with av.open(str(video)) as container:
            if not container.streams.video:
                raise InputError("the file has no picture", where=video, remedy="Give a video")
            stream = container.streams.video[0]
            stream.thread_type = "AUTO"
            rate = min(float(stream.average_rate or FASTEST), FASTEST)
            total = round((container.duration or 0) / av.time_base * rate)
            for frame in container.decode(stream):
                time = float(frame.time or 0)
                start = time if start is None else start
                place = round((time - start) * rate)
                if place > last:
                    last = place
                    yield rate, place, total, np.asarray(frame.to_ndarray(format="rgb24"), np.uint8)
    except av.FFmpegError as error:
        raise InputError(
            f"the video cannot be read ({error.strerror})",
            where=video,
            remedy="Export it again as MP4 (H.264)",
        ) from error
