"""The face of a motion that has none of its own, from the file of facial weights beside it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from motion.clip import MotionClip
from motion.errors import InputError
from motion.formats.arkit_json import read_arkit_json


def with_face_beside(clip: MotionClip, path: Path) -> tuple[MotionClip, list[str]]:
    """Return `clip` with the face that a recording has beside it, and what there is to say of it.

    BEAT and those who generate in its format keep a take's face in a JSON file of the same name.

    Parameters
    ----------
    clip : MotionClip
        A motion; one that has a face is returned as it is.
    path : Path
        The file that it was read from.

    Returns
    -------
    MotionClip
        Frames behind the face's last one hold that.
    list of str
        For the researcher to read; a file that is no face is left out and named.
    """
    beside = path.with_suffix(".json")
    if clip.arkit is not None or clip.expressions is not None or not beside.is_file():
        return clip, []
    try:
        face = read_arkit_json(beside, clip.frame_rate)
    except InputError as error:
        return clip, [f"{beside.name} lies beside {path.name} and is left out: {error.what}"]
    shown = face[np.minimum(np.arange(len(clip)), len(face) - 1)]
    return replace(clip, arkit=shown), [f"{path.name}: the face is that of {beside.name}"]
