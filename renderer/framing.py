"""One camera for a whole study, so that framing does not reveal the condition."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_NAMES, forward_kinematics, joint_index
from renderer.look import VIEWS, Look

_FIELD_OF_VIEW: Final = 20.0
"""Degrees; narrow, like a portrait lens, so that hands held forward do not look larger."""

_CLOSE_FIELD_OF_VIEW: Final = 8.0
"""Degrees, for faces from the same distance, for the same reason."""

_MARGIN: Final = 0.04
"""Share of half the picture that stays empty on each side."""

_STEP: Final = 0.02
"""Metres to which cameras are rounded, so that replacing a clip rarely means redrawing all."""

_POSITION_PERCENTILE: Final = 99.5
"""Percentile of a clip's positions that must be visible, so that stray frames do not count."""

_CLIP_PERCENTILE: Final = 97
"""Percentile of clips that must fit, so that a clip that wanders off does not shrink all others."""

_ABOVE_HEAD: Final = 0.19  # from the head joint to the top of the hair, in metres
_BELOW_FOOT: Final = 0.09
_AROUND_HEAD: Final = np.array(  # from the head joint, in metres: hair, ears, nose
    [(0, _ABOVE_HEAD, 0), (0.11, 0.05, 0), (-0.11, 0.05, 0), (0, 0.05, 0.13)]
)
_AROUND_FINGER: Final = 0.04 * np.array(  # from the last finger joint to the tip
    [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)]
)
_MAX_FRAMES: Final = 400
_HANDS: Final = tuple(
    joint_index(name)
    for name in JOINT_NAMES
    if name.endswith(("3", "wrist")) and "spine" not in name
)
_FEET, _ELBOWS = (
    tuple(joint_index(f"{side}_{part}") for side in ("left", "right")) for part in ("foot", "elbow")
)


@dataclass(frozen=True, kw_only=True)
class Camera:
    """An upright camera; `dataclasses.asdict` makes it JSON.

    Attributes
    ----------
    eye, target : tuple of float
        Positions of the camera and of its target, in metres.
    field_of_view : float
        Angle of view along each side of the square picture, in degrees.
    """

    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    field_of_view: float


def frame_clips(clips: Iterable[MotionClip], body: BodyModel, look: Look) -> Camera:
    """Return the level camera that shows the look's framing in all of `clips`.

    Parameters
    ----------
    clips : iterable of MotionClip
        Every clip that the study shows, as it is shown (frozen channels frozen), except catch
        motion, which may throw its arms anywhere.
    body : BodyModel
        The body that shows them.
    look : Look
        Its framing sets the visible parts: the whole body (``full_body``), everything above the
        hips and the hands wherever they are (``upper_body``), head and neck (``face``), or hands
        and lower arms (``hands``). Its view sets the direction.

    Raises
    ------
    InputError
        If there are no clips.
    """
    turn = VIEWS[look.view]
    points = [_rotated(_points_to_show(clip, body, look), -turn) for clip in clips]
    if not points:
        raise InputError("there is no clip to frame", remedy="Generate or import motion first")
    all_points = np.concatenate(points)
    middle = _rounded(np.median([np.median(part[:, 0]) for part in points]))
    low, high = np.percentile(all_points[:, 1], [100 - _POSITION_PERCENTILE, _POSITION_PERCENTILE])
    top = max(float(np.median([part[:, 1].max() for part in points])), float(high))
    height = _rounded((float(low) + top) / 2)
    depth = _rounded(np.median(all_points[:, 2]))
    field_of_view = _CLOSE_FIELD_OF_VIEW if look.framing == "face" else _FIELD_OF_VIEW
    slope = np.tan(np.radians(field_of_view / 2))
    halves = [_half_extent(part, middle, height, depth, slope) for part in points]
    # Clip by clip, so that a condition with wide gestures is not outvoted by the others.
    half = np.percentile(halves, _CLIP_PERCENTILE, method="higher")
    distance = np.ceil(half / _STEP) * _STEP / slope
    eye = (middle, height, round(float(depth + distance), 4))
    ends = np.array([eye, (middle, height, depth)])
    (x, y, z), (a, b, c) = np.round(_rotated(ends, turn), 4).tolist()
    return Camera(eye=(x, y, z), target=(a, b, c), field_of_view=field_of_view)


def _rotated(points: Floats, turn: float) -> Floats:
    """Return `points`, shape (n, 3), turned by degrees from +z towards +x."""
    if not turn:
        return points
    return np.asarray(Rotation.from_euler("y", turn, degrees=True).apply(points))


def _half_extent(points: Floats, middle: float, height: float, depth: float, slope: float) -> float:
    """Return half the extent of the picture at `depth` that just contains `points`."""
    aside = np.maximum(np.abs(points[:, 0] - middle), np.abs(points[:, 1] - height))
    half = aside / (1 - _MARGIN) + slope * (points[:, 2] - depth)
    return float(np.percentile(half, _POSITION_PERCENTILE))


def _rounded(metres: float | np.floating) -> float:
    """Round to the nearest step, so that slightly different clips keep their camera."""
    return round(round(float(metres) / _STEP) * _STEP, 4)


def _points_to_show(clip: MotionClip, body: BodyModel, look: Look) -> Floats:
    """Return points of the posed body that must be in the picture, shape (n, 3)."""
    step = max(1, len(clip) // _MAX_FRAMES)
    sampled = clip.frames(slice(None, None, step))
    positions, turns = forward_kinematics(sampled.poses, sampled.trans, body.joints(clip.betas))
    head = joint_index("head")
    if look.framing == "face":
        outline = positions[:, head, None] + (turns[:, head] @ _AROUND_HEAD.T).transpose(0, 2, 1)
        return np.concatenate([outline.reshape(-1, 3), positions[:, joint_index("neck")]])
    crown = positions[:, head] + turns[:, head] @ np.array([0.0, _ABOVE_HEAD, 0.0])
    hands = positions[:, _HANDS].reshape(-1, 3)
    fingers = (hands[:, None] + _AROUND_FINGER).reshape(-1, 3)
    if look.framing == "hands":
        other_points = [positions[:, _ELBOWS].reshape(-1, 3)]
    elif look.framing == "full_body":
        other_points = [crown, positions[:, _FEET].reshape(-1, 3) - [0, _BELOW_FOOT, 0]]
    else:
        other_points = [crown, positions[:, joint_index("pelvis")] - [0, 0.1, 0]]
    # Repeated, so that many fingers do not outvote few heads and hips in a percentile.
    repeats = max(1, len(hands) // len(crown) // 2)
    return np.concatenate([fingers, *(np.repeat(sampled, repeats, 0) for sampled in other_points)])


def project(points: NDArray[np.floating], camera: Camera, size: int) -> Floats:
    """Project `points` into a picture of `size` × `size` pixels.

    Parameters
    ----------
    points : ndarray, shape (..., 3)
        Positions in metres.
    camera : Camera
        The camera.
    size : int
        Pixels along each side.

    Returns
    -------
    ndarray, shape (..., 3)
        Pixels from the left and from the top, and distance in front of the camera in metres. Points
        behind the camera are NaN.
    """
    pose = look_at(np.array(camera.eye), np.array(camera.target))
    in_camera = (np.asarray(points, float) - pose[:3, 3]) @ pose[:3, :3]
    ahead = np.where(in_camera[..., 2] < 0, -in_camera[..., 2], np.nan)
    half_size = ahead * np.tan(np.radians(camera.field_of_view / 2))
    x = (in_camera[..., 0] / half_size + 1) / 2 * size
    y = (1 - in_camera[..., 1] / half_size) / 2 * size
    return np.stack([x, y, ahead], axis=-1)


def look_at(eye: Floats, target: Floats) -> Floats:
    """Return the pose, shape (4, 4), of a camera at `eye` that looks at `target`, y up."""
    back = eye - target
    back = back / np.linalg.norm(back)
    right = np.cross([0.0, 1.0, 0.0], back)
    right = right / np.linalg.norm(right)
    pose = np.eye(4)
    pose[:3, :4] = np.stack([right, np.cross(back, right), back, eye], axis=1)
    return pose
