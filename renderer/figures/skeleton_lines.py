"""The skeleton drawn over a frame: SMPL-X's joints and bones as the camera sees them."""

from __future__ import annotations

from typing import Final

import numpy as np
from PIL import Image, ImageDraw

from motion.arrays import Floats
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import FACE_JOINTS, JOINT_NAMES, PARENTS, forward_kinematics
from renderer.figures.plate import INK, font
from renderer.framing import Camera, project

SIDE_COLOURS: Final = {"left": (0xD5, 0x5E, 0x00), "right": (0x00, 0x72, 0xB2)}
"""Vermilion and blue of Okabe and Ito's palette, for any kind of colour vision."""

SIDE_MARKS: Final = {"left": "●", "right": "■"}
"""The shape of each side's joints."""

_MIDDLE_COLOUR: Final = (0x30, 0x30, 0x36)
_HALO: Final = (0xFF, 0xFF, 0xFF)
_BONE_SHARE: Final = 0.008  # of the picture's width
_FINGER_SHARE: Final = 0.004
_JOINT_SHARE: Final = 0.0085
_OVERSAMPLING: Final = 3
_LETTER_SHARE: Final = 0.032
_BONES: Final = tuple(
    (joint, parent)
    for joint, parent in enumerate(PARENTS)
    if parent >= 0 and JOINT_NAMES[joint] not in FACE_JOINTS
)


def joints_of(clip: MotionClip, body: BodyModel) -> Floats:
    """Return the joints of `body` in each frame of `clip`, shape (T, 55, 3)."""
    positions, _ = forward_kinematics(clip.poses, clip.trans, body.joints(clip.betas))
    return positions


def with_skeleton(
    picture: Image.Image, joints: Floats, camera: Camera, *, key: bool = True
) -> Image.Image:
    """Return `picture` with the skeleton drawn over the body.

    The speaker's left is vermilion with round joints, their right blue with square ones.

    Parameters
    ----------
    picture : Image
        A square frame as `camera` sees it.
    joints : ndarray, shape (55, 3)
        Positions of the joints in that frame, in metres.
    camera : Camera
        The picture's camera.
    key : bool
        Whether a key in the corner explains the colours.
    """
    size = picture.width
    lines = _skeleton_picture(project(joints, camera, size)[:, :2], size, key=key)
    result = picture.convert("RGBA")
    result.alpha_composite(lines)
    return result.convert(picture.mode)


def _skeleton_picture(points: Floats, size: int, *, key: bool) -> Image.Image:
    """Return the skeleton with joints at `points`, shape (55, 2), on a clear picture."""
    width = size * _OVERSAMPLING
    points = points * _OVERSAMPLING
    large = Image.new("RGBA", (width, width))
    pen = ImageDraw.Draw(large)
    visible = [bone for bone in _BONES if np.isfinite(points[list(bone)]).all()]
    # All rims first: a bone's rim must not cut the bone that it crosses.
    for rim in (True, False):
        for bone in visible:
            _draw_bone(pen, points, bone, width, rim=rim)
    if key:
        _draw_key(pen, width)
    return large.convert("RGBa").reduce(_OVERSAMPLING).convert("RGBA")


def _draw_bone(
    pen: ImageDraw.ImageDraw, points: Floats, bone: tuple[int, int], size: int, *, rim: bool
) -> None:
    """Draw the bone from a joint to its parent, and the joint."""
    joint, parent = bone
    name = JOINT_NAMES[joint]
    finger = name[-1].isdigit() and "spine" not in name
    edge = 0.0022 * size if rim else 0.0
    colour = _HALO if rim else SIDE_COLOURS.get(name.split("_")[0], _MIDDLE_COLOUR)
    width = (_FINGER_SHARE if finger else _BONE_SHARE) * size + 2 * edge
    pen.line([tuple(points[parent]), tuple(points[joint])], fill=colour, width=round(width))
    radius = (_JOINT_SHARE * (0.45 if finger else 1)) * size + edge
    _draw_joint(pen, points[joint], radius, colour, square=name.startswith("right_"))


def _draw_joint(
    pen: ImageDraw.ImageDraw,
    centre: Floats,
    radius: float,
    colour: tuple[int, int, int],
    *,
    square: bool,
) -> None:
    corners = [tuple(centre - radius), tuple(centre + radius)]
    if square:
        pen.rectangle(corners, fill=colour)
    else:
        pen.ellipse(corners, fill=colour)


def _draw_key(pen: ImageDraw.ImageDraw, size: int) -> None:
    """Label the sides in the lower left corner."""
    letters = font(_LETTER_SHARE * size)
    left = margin = 0.03 * size
    middle = size - margin - _LETTER_SHARE * size / 2
    for name, colour in SIDE_COLOURS.items():
        centre = np.array([left + _JOINT_SHARE * size, middle])
        _draw_joint(pen, centre, _JOINT_SHARE * size, colour, square=name == "right")
        left += 0.026 * size
        pen.text(
            (left, middle), name, INK, letters, anchor="lm",
            stroke_width=0.003 * size, stroke_fill=_HALO,
        )  # fmt: skip
        left += letters.getlength(name) + 0.03 * size
