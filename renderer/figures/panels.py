"""Frames of several clips, cut to the part of the picture that any of them fills."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final

import numpy as np
from PIL import Image

from motion.body.model import BodyModel
from motion.clip import MotionClip
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
