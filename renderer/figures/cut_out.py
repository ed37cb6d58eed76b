"""The figure alone, without its background."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from scipy.ndimage import minimum_filter

from motion.body.model import BodyModel
from motion.clip import MotionClip
from renderer.clip_video import Stage
from renderer.frames import SUPERSAMPLING
from renderer.framing import Camera, project
from renderer.look import BACKGROUND
from renderer.stills import large_still

Box = tuple[float, float, float, float]
"""Left, top, right and bottom of a part of a picture, in shares of its sides."""

FAR: Final = np.float32(1e9)
"""Depth where there is no figure, in metres."""

_SAME_COLOUR: Final = 2
"""By how much of 255 a pixel of the background may differ from it."""


@dataclass(frozen=True, eq=False)
class CutOut:
    """A figure without background.

    Attributes
    ----------
    picture : Image
        RGBA, clear where the figure is not.
    depth : ndarray, shape (height, width), float32
        How far before the camera the figure is at each pixel, in metres; `FAR` beside it.
    """

    picture: Image.Image
    depth: NDArray[np.float32]

    def within(self, box: Box) -> CutOut:
        """Return the part inside `box`, widened to whole pixels."""
        left, top = (math.floor(share * self.picture.width) for share in box[:2])
        right, bottom = (math.ceil(share * self.picture.width) for share in box[2:])
        return CutOut(
            self.picture.crop((left, top, right, bottom)), self.depth[top:bottom, left:right]
        )


def cut_out(stage: Stage, pose: MotionClip, camera: Camera) -> CutOut:
    """Return the figure alone, of the look's size.

    Parameters
    ----------
    stage : Stage
        Where it is drawn; entered.
    pose : MotionClip
        One frame.
    camera : Camera
        The camera of `stage`.
    """
    drawn = large_still(stage, pose)
    # Colour alone does not tell where the figure is: its shadow on the floor is no part of it.
    depth = _depth(stage.body, pose, camera, drawn.width)
    near = minimum_filter(depth, 3) < FAR
    differs = (
        np.abs(np.asarray(drawn, np.int16) - np.array(BACKGROUND, np.int16)).max(axis=-1)
        > _SAME_COLOUR
    )
    drawn.putalpha(Image.fromarray(np.where(near & differs, 255, 0).astype(np.uint8)))
    # Averaged with colours weighed by alpha, so that the background's colour leaves no rim.
    picture = drawn.convert("RGBa").reduce(SUPERSAMPLING).convert("RGBA")
    blocks = depth.reshape(picture.height, SUPERSAMPLING, picture.width, SUPERSAMPLING)
    return CutOut(picture, blocks.min(axis=(1, 3)))


def box_around(body: BodyModel, pose: MotionClip, camera: Camera) -> Box:
    """Return which part of the picture `body` fills in one frame."""
    corners = project(body.vertices(pose)[0], camera, 1)[:, :2]
    left, top = np.clip(corners.min(axis=0), 0, 1)
    right, bottom = np.clip(corners.max(axis=0), 0, 1)
    return float(left), float(top), float(right), float(bottom)


def _depth(body: BodyModel, pose: MotionClip, camera: Camera, side: int) -> NDArray[np.float32]:
    """Return the depth at each pixel of a square picture, each triangle as one flat step."""
    corners = project(body.vertices(pose)[0], camera, side)[body.faces]
    depths = corners[..., 2].mean(axis=1)
    image = Image.new("F", (side, side), float(FAR))
    pen = ImageDraw.Draw(image)
    far_first = np.argsort(-depths, kind="stable")
    flat = corners[far_first, :, :2].reshape(-1, 6).tolist()
    for triangle, depth in zip(flat, depths[far_first].tolist(), strict=True):
        pen.polygon(triangle, fill=depth)
    return np.array(image)
