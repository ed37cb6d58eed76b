"""Finding one person in a video with MediaPipe, whose package holds its networks."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import av
import numpy as np
from av.container import InputContainer
from numpy.typing import NDArray

from motion.audio import LONGEST
from motion.errors import InputError
from motion.points.detection import Detection

FASTEST: Final = 30.0
"""Frames per second that are looked at, of a video that has more."""

_POSE: Final = 33
_FACE: Final = 478
_REPEATED: Final = 0.5
"""Seconds for which a frame stands where the next comes late."""


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
