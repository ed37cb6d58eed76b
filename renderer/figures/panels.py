"""Frames of several clips: the figure alone, cropped to a common box, or its face.

Faces have their own camera because lips, brows and eyes are too small in a study's own picture.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
from PIL import Image, ImageDraw
from scipy.ndimage import minimum_filter

from motion.arrays import Floats, Floats32
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import forward_kinematics, joint_index
from renderer.clip_video import Stage, large_still, still
from renderer.framing import Camera, look_at, project
from renderer.picture import SUPERSAMPLING

Box = tuple[float, float, float, float]
"""Left, top, right and bottom of a part of a picture, as shares of its sides."""

NO_DEPTH: Final = np.float32(1e9)
"""Depth of pixels outside the figure, in metres."""

_COLOUR_TOLERANCE: Final = 2
"""Largest difference of a background pixel from the background's colour, of 255."""

_MARGIN: Final = 0.02
FULL_BOX: Final[Box] = (0.0, 0.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class CutOut:
    """A figure without background.

    Attributes
    ----------
    picture : Image
        RGBA, transparent outside the figure.
    depth : ndarray, shape (height, width), float32
        Distance of the figure from the camera at each pixel, in metres; `NO_DEPTH` elsewhere.
    """

    picture: Image.Image
    depth: Floats32

    def crop(self, box: Box) -> CutOut:
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
        The stage that draws it; entered.
    pose : MotionClip
        A clip of one frame.
    camera : Camera
        The camera of `stage`.
    """
    large = large_still(stage, pose)
    # Colour alone cannot mask the figure: its shadow on the floor is not part of it.
    depth = _depth(stage.body, pose, camera, large.width)
    in_figure = minimum_filter(depth, 3) < NO_DEPTH
    differs = (
        np.abs(np.asarray(large, np.int16) - np.array(stage.look.background, np.int16)).max(axis=-1)
        > _COLOUR_TOLERANCE
    )
    large.putalpha(Image.fromarray(np.where(in_figure & differs, 255, 0).astype(np.uint8)))
    # Averaged with colours weighted by alpha, so that the background's colour leaves no rim.
    picture = large.convert("RGBa").reduce(SUPERSAMPLING).convert("RGBA")
    blocks = depth.reshape(picture.height, SUPERSAMPLING, picture.width, SUPERSAMPLING)
    return CutOut(picture, blocks.min(axis=(1, 3)))


def _depth(body: BodyModel, pose: MotionClip, camera: Camera, size: int) -> Floats32:
    """Return the depth at each pixel of a square picture; each triangle has one depth."""
    corners = project(body.vertices(pose)[0], camera, size)[body.faces]
    depths = corners[..., 2].mean(axis=1)
    image = Image.new("F", (size, size), float(NO_DEPTH))
    pen = ImageDraw.Draw(image)
    far_first = np.argsort(-depths, kind="stable")
    flat = corners[far_first, :, :2].reshape(-1, 6).tolist()
    for triangle, depth in zip(flat, depths[far_first].tolist(), strict=True):
        pen.polygon(triangle, fill=depth)
    return np.array(image)


def common_box(body: BodyModel, poses: Iterable[MotionClip], camera: Camera) -> Box:
    """Return the part of the picture that holds the figure in all `poses`, with a margin."""
    points = np.concatenate([project(body.vertices(pose)[0], camera, 1)[:, :2] for pose in poses])
    low, high = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    left, top, right, bottom = np.clip([*low, *high], 0, 1).tolist()
    return left, top, right, bottom


def panel(stage: Stage, pose: MotionClip, camera: Camera, *, clear: bool) -> Image.Image:
    """Return the frame of `pose` as RGBA, without the background if `clear`."""
    return cut_out(stage, pose, camera).picture if clear else still(stage, pose, 0).convert("RGBA")


def cropped(picture: Image.Image, box: Box, size: tuple[int, int]) -> Image.Image:
    """Return the part of `picture` inside `box`, scaled to `size` pixels."""
    width = picture.width
    left, top, right, bottom = (share * width for share in box)
    return picture.resize(size, Image.Resampling.LANCZOS, box=(left, top, right, bottom))


def aspect_of(box: Box) -> float:
    """Return the height of `box` over its width."""
    left, top, right, bottom = box
    return (bottom - top) / (right - left)


def joints_of(clip: MotionClip, body: BodyModel) -> Floats:
    """Return the joints of `body` in each frame of `clip`, shape (T, 55, 3)."""
    positions, _ = forward_kinematics(clip.poses, clip.trans, body.joints(clip.betas))
    return positions


_FACE_MARGIN: Final = 0.17
"""Metres from the point between the eyes to the edge of the picture, for a still head."""
_BELOW_EYES: Final = 0.03


def align_faces(groups: Iterable[Sequence[MotionClip]], body: BodyModel) -> list[list[MotionClip]]:
    """Return groups of clips translated so that the faces of all groups coincide.

    Seated speakers would otherwise be below a picture of standing ones. Clips of one group keep
    their positions relative to each other.

    Parameters
    ----------
    groups : iterable of sequence of MotionClip
        At least one clip in each, such as the moments of one condition.
    body : BodyModel
        The body that shows them.
    """
    clips_of_group = [list(group) for group in groups]
    middles = [_range_of_faces(group, body).mean(axis=0) for group in clips_of_group]
    return [
        [
            replace(clip, trans=clip.trans + (middles[0] - middle).astype(np.float32))
            for clip in group
        ]
        for group, middle in zip(clips_of_group, middles, strict=True)
    ]


def face_camera(clips: Iterable[MotionClip], body: BodyModel, camera: Camera) -> Camera:
    """Return a camera, moved from `camera`, that sees the faces of all `clips` in every frame.

    Parameters
    ----------
    clips : iterable of MotionClip
        The clips, at least one.
    body : BodyModel
        The body that shows them.
    camera : Camera
        Camera with the distance and direction; the result is moved vertically and sideways.
    """
    low, high = _range_of_faces(clips, body)
    middle, extent = (low + high) / 2, (high - low) / 2
    pose = look_at(np.array(camera.eye), np.array(camera.target))
    right, back = pose[:3, 0], pose[:3, 2]
    half = max(float(np.abs(right) @ extent), float(extent[1])) + _FACE_MARGIN
    depth = float((camera.eye - middle) @ back)
    target = middle - [0, _BELOW_EYES, 0]
    (x, y, z), (a, b, c) = (target + depth * back).tolist(), target.tolist()
    return Camera(
        eye=(x, y, z),
        target=(a, b, c),
        field_of_view=float(np.degrees(2 * np.arctan(half / (depth - np.abs(back) @ extent)))),
    )


def _range_of_faces(clips: Iterable[MotionClip], body: BodyModel) -> Floats:
    """Return the smallest and largest coordinates of the point between the eyes, shape (2, 3)."""
    eyes = [joint_index("left_eye"), joint_index("right_eye")]
    points = np.concatenate([joints_of(clip, body)[:, eyes].mean(axis=1) for clip in clips])
    return np.stack([points.min(axis=0), points.max(axis=0)])
