"""SMPL-X parameters side by side in the rows of one array, at 30 fps.

TalkSHOW (Yi et al. 2023) writes ``.npy`` of shape (T, 265), Motion-X (Lin et al. 2023) of shape
(T, 322). SHOW's own files have TalkSHOW's parts by name, as arrays of an ``.npz``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import EXPRESSION_COUNT, MotionClip
from motion.errors import InputError, found_at
from motion.formats.archives import load_array, load_arrays
from motion.skeleton import JOINT_COUNT

FRAME_RATE: Final = 30.0
WIDTH: Final = 265
_JAW_AND_EYES: Final = slice(0, 9)
_PELVIS: Final = slice(9, 12)
_BODY: Final = slice(12, 75)
_HANDS: Final = slice(75, 165)
_EXPRESSION: Final = slice(165, 265)

_PARTS: Final = (
    ("jaw_pose", 3),
    ("leye_pose", 3),
    ("reye_pose", 3),
    ("global_orient", 3),
    ("body_pose_axis", 63),
    ("left_hand_pose", 45),
    ("right_hand_pose", 45),
    ("expression", 100),
)
"""SHOW's names for the parts of a row, in column order, and their widths."""

MOTION_X_WIDTH: Final = 322

ARRAYS: Final = ("body_pose_axis",)
"""Arrays that only SHOW's ``.npz`` has."""


def read_show_npz(path: Path) -> MotionClip:
    """Read SHOW's motion from an ``.npz`` of its own arrays, at 30 fps.

    Parameters
    ----------
    path : Path
        A file with the arrays ``jaw_pose``, ``leye_pose``, ``reye_pose``, ``global_orient``,
        ``body_pose_axis``, ``left_hand_pose``, ``right_hand_pose`` and ``expression``, one row per
        frame; axis-angle in radians. Other arrays are ignored.

    Raises
    ------
    InputError
        If an array is missing or of another size. Hands as SHOW's 12 principal components are
        refused: they must be 45 angles. Pickled content is never loaded.
    """
    with found_at(path):
        arrays = load_arrays(path, [name for name, _ in _PARTS])
        parts = [_part(arrays.get(name), name, width) for name, width in _PARTS]
        if len({len(part) for part in parts}) > 1:
            raise InputError(
                "the arrays are not of equal length", remedy="Save all of SHOW's arrays"
            )
        return _clip(np.concatenate(parts, axis=1), FRAME_RATE)


def _part(array: NDArray[Any] | None, name: str, width: int) -> NDArray[Any]:
    if array is None or array.dtype.kind not in "fiu" or not array.size:
        problem = "there is no array" if array is None else "there are no numbers in the array"
        raise InputError(f"{problem} {name!r}", remedy="Save all of SHOW's arrays")
    rows = array.reshape(len(array), -1)
    if rows.shape[1] != width:
        hands = "; expand the principal components of hands" if "hand" in name else ""
        raise InputError(
            f"{name!r} has shape {array.shape}", remedy=f"Give (frames, {width}){hands}"
        )
    return rows


def read_rows(path: Path, *, frame_rate: float | None = None) -> MotionClip:
    """Read TalkSHOW's or Motion-X's rows unchanged, with fingers relative to the mean hands.

    Parameters
    ----------
    path : Path
        A ``.npy`` file, axis-angle in radians. TalkSHOW's rows hold jaw, eyes, pelvis, body, left
        hand, right hand, then 100 expression coefficients; for Motion-X's see `motion_x_clip`.
    frame_rate : float, optional
        Frames per second; 30 by default.

    Returns
    -------
    MotionClip
        Its provenance names the format (``format``).

    Raises
    ------
    InputError
        If the file is not such an array. Pickled content is never loaded.
    """
    rate = FRAME_RATE if frame_rate is None else frame_rate
    with found_at(path):
        rows = load_array(path)
        width = rows.shape[1] if rows.ndim == 2 else 0
        if width not in (WIDTH, MOTION_X_WIDTH) or rows.dtype.kind not in "fiu":
            raise InputError(
                f"the array has shape {rows.shape} and type {rows.dtype}",
                remedy=f"Give TalkSHOW's (T, {WIDTH}) or Motion-X's (T, {MOTION_X_WIDTH}) numbers, "
                "or save SMPL-X's poses in an .npz, as 'poses' with 'mocap_frame_rate'",
            )
        if width == MOTION_X_WIDTH:
            return motion_x_clip(rows, rate).with_provenance(format="motion-x")
        return _clip(rows, rate).with_provenance(format="talkshow")


def motion_x_clip(rows: NDArray[Any], frame_rate: float) -> MotionClip:
    """Return Motion-X's rows, shape (T, 322), as a clip.

    They hold pelvis, 21 body joints, left and right hand, jaw, 50 expression coefficients, 100
    coefficients of the face's shape, translation and 10 betas. Eyes stay at rest, and the shape of
    the face is ignored.
    """
    body_and_hands, jaw, expression, _, trans, betas = np.split(
        rows, [156, 159, 209, 309, 312], axis=1
    )
    body, hands = np.split(body_and_hands, [66], axis=1)
    eyes = np.zeros((len(rows), 6), np.float32)
    return MotionClip(
        poses=np.concatenate([body, jaw, eyes, hands], axis=1).reshape(-1, JOINT_COUNT, 3),
        trans=trans,
        frame_rate=frame_rate,
        betas=betas[0] if len(betas) else np.zeros(0, np.float32),
        expressions=np.pad(expression, ((0, 0), (0, EXPRESSION_COUNT - expression.shape[1]))),
    )


def _clip(rows: NDArray[Any], frame_rate: float) -> MotionClip:
    """Return TalkSHOW's rows, shape (T, 265), as a clip; they hold no translation and no betas."""
    parts = (rows[:, part] for part in (_PELVIS, _BODY, _JAW_AND_EYES, _HANDS))
    return MotionClip(
        poses=np.concatenate(list(parts), axis=1).reshape(len(rows), JOINT_COUNT, 3),
        trans=np.zeros((len(rows), 3), np.float32),
        frame_rate=frame_rate,
        expressions=rows[:, _EXPRESSION],
    )
