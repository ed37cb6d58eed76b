"""Motion of SHOW and TalkSHOW (Yi et al. 2023): ``.npy`` of shape (T, 265) at 30 fps."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import JOINT_COUNT

FRAME_RATE: Final = 30.0
WIDTH: Final = 265
_JAW_AND_EYES: Final = slice(0, 9)
_PELVIS: Final = slice(9, 12)
_BODY: Final = slice(12, 75)
_HANDS: Final = slice(75, 165)
_EXPRESSION: Final = slice(165, 265)


def read_talkshow(path: Path, *, frame_rate: float | None = None) -> MotionClip:
    """Read a TalkSHOW motion, as it stands; the file holds no translation and no betas.

    Its fingers are relative to SMPL-X's mean hands.

    Parameters
    ----------
    path : Path
        A ``.npy`` file: jaw, eyes, pelvis, body, left hand, right hand (axis-angle), then 100
        expression coefficients in each row.
    frame_rate : float, optional
        Frames per second where it is not TalkSHOW's 30.

    Raises
    ------
    InputError
        If the file is no such array. Pickled content is never loaded.
    """
    try:
        rows = np.load(path, allow_pickle=False)
    except (OSError, EOFError, ValueError, OverflowError, MemoryError) as error:
        raise InputError(
            "the file cannot be read as a plain array", where=path, remedy="Save it with numpy.save"
        ) from error
    if rows.ndim != 2 or rows.shape[1] != WIDTH or rows.dtype.kind not in "fiu":
        raise InputError(
            f"the array has shape {rows.shape} and type {rows.dtype}",
            where=path,
            remedy=f"Give TalkSHOW's (T, {WIDTH}) numbers",
        )
    parts = (rows[:, part] for part in (_PELVIS, _BODY, _JAW_AND_EYES, _HANDS))
    try:
        return MotionClip(
            poses=np.concatenate(list(parts), axis=1).reshape(len(rows), JOINT_COUNT, 3),
            trans=np.zeros((len(rows), 3), np.float32),
            frame_rate=FRAME_RATE if frame_rate is None else frame_rate,
            expressions=rows[:, _EXPRESSION],
        )
    except InputError as error:
        raise InputError(error.what, where=path, remedy=error.remedy) from error
