"""Which parts of a clip's face and shape a body can show, and notes on what it cannot.

SMPL-X's expression coefficients and ARKit's facial actions are different spaces. The conversion
between them depends on whose faces were measured, so the program has no matrix for it; researchers
bring their own.
"""

from __future__ import annotations

from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from motion.arrays import Floats32
from motion.clip import ARKIT_COUNT, EXPRESSION_COUNT, LARGEST_VALUE, MotionClip
from motion.errors import InputError
from motion.skeleton import FACE_JOINTS, joint_index

if TYPE_CHECKING:
    from motion.body.model import BodyModel

_NAMES: Final = {"arkit": "ARKit weights", "expressions": "SMPL-X expression coefficients"}
_FACE: Final = [joint_index(name) for name in FACE_JOINTS]


def unsupported(clip: MotionClip, body: BodyModel) -> tuple[str, ...]:
    """Return a sentence for each feature of `clip` that `body` cannot show."""
    return tuple(chain(_expression_notes(clip, body), _shape_notes(clip, body)))


def _expression_notes(clip: MotionClip, body: BodyModel) -> tuple[str, ...]:
    """Return a note if the face stays still although the clip moves it.

    ARKit weights and SMPL-X's expression coefficients are different spaces; a body has slots for
    one of them, and neither is guessed from the other.
    """
    moving = [name for name, face in clip.faces.items() if np.any(face)]
    if not body.expression_directions.size:
        if not moving and not clip.poses[:, _FACE].any():
            return ()
        return (
            "the clip moves its face, and this body has none: nothing of expression, jaw and eyes "
            "is shown (choose an avatar with a face)",
        )
    body_face = "arkit" if body.has_arkit_slots else "expressions"
    if not moving or body_face in clip.faces or body.expression_matrix is not None:
        return ()
    return (
        f"the clip's face is given as {_NAMES[moving[0]]}, which this body has no slots for; its "
        f"face moves by jaw and eyes alone (name a matrix to {_NAMES[body_face]} as "
        "video.expression_matrix, or choose another body)",
    )


def _shape_notes(clip: MotionClip, body: BodyModel) -> tuple[str, ...]:
    """Return a note if the body's shape differs from the clip's."""
    known = body.shape_directions.shape[2]
    if not np.any(clip.betas[known:]):
        return ()
    if known:
        return (f"only the first {known} of the clip's {len(clip.betas)} betas shape this body",)
    return (
        "the clip gives a body shape (betas), which this body does not take on (name a licensed "
        "SMPL-X model as video.body to show it)",
    )


def read_expression_matrix(path: Path) -> Floats32:
    """Read the matrix from a ``.npy`` file.

    Parameters
    ----------
    path : Path
        The file; nothing in it is unpickled.

    Returns
    -------
    ndarray, shape (100, 52), float32
        One row for each expression coefficient, one column for each action in the order of
        `motion.clip.ARKIT_NAMES`.

    Raises
    ------
    InputError
        If the file is missing, cannot be read, or is not such a matrix of finite numbers.
    """
    try:
        with path.open("rb") as file:
            array = np.lib.format.read_array(file, allow_pickle=False)
        if array.dtype.kind not in "fiu" or array.shape != (EXPRESSION_COUNT, ARKIT_COUNT):
            raise ValueError(f"its shape is {array.shape}, its type {array.dtype}")
        if not (np.abs(array) <= LARGEST_VALUE).all():
            raise ValueError("it holds NaN, infinite or huge values")
    except (ValueError, OSError) as error:
        raise InputError(
            f"this is not an expression matrix: {error}",
            where=path,
            remedy="Save numbers for 100 SMPL-X coefficients by 52 ARKit actions with numpy.save",
        ) from error
    return np.ascontiguousarray(array, np.float32)
