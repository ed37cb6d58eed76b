"""SMPL-X parameters side by side in the rows of one array, at 30 fps.

TalkSHOW (Yi et al. 2023) writes ``.npy`` of shape (T, 265), Motion-X (Lin et al. 2023) of shape
(T, 322).
"""

from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.clip import EXPRESSION_COUNT, MotionClip
from motion.errors import InputError, found_at
from motion.formats.archives import load_array
from motion.skeleton import JOINT_COUNT

FRAME_RATE: Final = 30.0
WIDTH: Final = 265
MOTION_X_WIDTH: Final = 322


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
    jaw_and_eyes, pelvis, body, hands, expression = np.split(rows, [9, 12, 75, 165], axis=1)
    return MotionClip(
        poses=np.concatenate([pelvis, body, jaw_and_eyes, hands], axis=1).reshape(
            -1, JOINT_COUNT, 3
        ),
        trans=np.zeros((len(rows), 3), np.float32),
        frame_rate=frame_rate,
        expressions=expression,
    )
