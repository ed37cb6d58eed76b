"""Frames of several clips, cut to what any of them fills, and cameras close to their faces.

What lips, brows and eyes do is too small to see in a study's own picture.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import joint_index
from renderer.clip_video import Stage
from renderer.figures.cut_out import Box, box_around, cut_out
from renderer.figures.skeleton_lines import joints_of, with_skeleton
from renderer.framing import Camera
from renderer.stills import still

_MARGIN: Final = 0.02
WHOLE: Final[Box] = (0.0, 0.0, 1.0, 1.0)


def common_box(body: BodyModel, poses: Iterable[MotionClip], camera: Camera) -> Box:
    """Return the part of the picture that holds the figure in all `poses`, with a margin."""
    boxes = np.array([box_around(body, pose, camera) for pose in poses])
    left, top = np.maximum(boxes[:, :2].min(axis=0) - _MARGIN, 0)
    right, bottom = np.minimum(boxes[:, 2:].max(axis=0) + _MARGIN, 1)
    return float(left), float(top), float(right), float(bottom)


def panel(
    stage: Stage, pose: MotionClip, camera: Camera, *, clear: bool, skeleton: bool = False
) -> Image.Image:
    """Return the frame of `pose` as RGBA: the figure alone where `clear`, else with background."""
    picture = (
        cut_out(stage, pose, camera).picture if clear else still(stage, pose, 0).convert("RGBA")
    )
    if skeleton:
        picture = with_skeleton(picture, joints_of(pose, stage.body)[0], camera, "over", key=False)
    return picture


def cropped(picture: Image.Image, box: Box, size: tuple[int, int]) -> Image.Image:
    """Return the part of `picture` inside `box`, scaled to `size` pixels."""
    side = picture.width
    left, top, right, bottom = (share * side for share in box)
    return picture.resize(size, Image.Resampling.LANCZOS, box=(left, top, right, bottom))


def aspect_of(box: Box) -> float:
    """Return the height of `box` over its width."""
    left, top, right, bottom = box
    return (bottom - top) / (right - left)


_FACE: Final = 0.17
"""Metres from between the eyes to the edge of the picture, where the head holds still."""
_BELOW_EYES: Final = 0.03


def faces_level(groups: Iterable[Sequence[MotionClip]], body: BodyModel) -> list[list[MotionClip]]:
    """Return groups of clips moved so that the faces of all groups are in one place.

    Somebody who sits is otherwise below a picture of those who stand. Within a group nothing moves
    against each other.

    Parameters
    ----------
    groups : iterable of sequence of MotionClip
        At least one clip in each, such as the moments of one condition.
    body : BodyModel
        The body that they are put on.
    """
    given = [list(group) for group in groups]
    middles = [_range_of_faces(group, body).mean(axis=0) for group in given]
    return [
        [
            replace(clip, trans=clip.trans + (middles[0] - middle).astype(np.float32))
            for clip in group
        ]
        for group, middle in zip(given, middles, strict=True)
    ]


def face_camera(clips: Iterable[MotionClip], body: BodyModel, camera: Camera) -> Camera:
    """Return a camera beside `camera` that sees the faces of all `clips`, all the time.

    Parameters
    ----------
    clips : iterable of MotionClip
        At least one; all are seen alike.
    body : BodyModel
        The body that they are put on.
    camera : Camera
        How far away it stands; it moves in height and to the side.
    """
    low, high = _range_of_faces(clips, body)
    x, y, z = (low + high) / 2
    half = float((high - low)[:2].max() / 2) + _FACE
    distance = camera.eye[2] - float(high[2])
    return Camera(
        eye=(float(x), float(y) - _BELOW_EYES, camera.eye[2]),
        target=(float(x), float(y) - _BELOW_EYES, float(z)),
        field_of_view=float(np.degrees(2 * np.arctan(half / distance))),
    )


def _range_of_faces(clips: Iterable[MotionClip], body: BodyModel) -> NDArray[np.float64]:
    """Return the least and the greatest place between the eyes, shape (2, 3)."""
    eyes = [joint_index("left_eye"), joint_index("right_eye")]
    points = np.concatenate([joints_of(clip, body)[:, eyes].mean(axis=1) for clip in clips])
    return np.stack([points.min(axis=0), points.max(axis=0)])
