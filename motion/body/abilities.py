"""What of a motion clip a body cannot show, said in sentences: nothing is dropped silently."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain
from typing import Final

import numpy as np

from motion.clip import MotionClip
from motion.skeleton import FACE_JOINTS, joint_index

_NAMES: Final = {"arkit": "ARKit weights", "expressions": "SMPL-X expression coefficients"}
_FACE: Final = [joint_index(name) for name in FACE_JOINTS]


@dataclass(frozen=True, kw_only=True)
class BodyAbilities:
    """What of a clip's face and shape a body can show.

    Attributes
    ----------
    has_face : bool
        Whether any facial expression moves it.
    has_arkit_slots : bool
        Whether it shows ARKit's facial actions, rather than SMPL-X's expression components.
    has_matrix : bool
        Whether it also shows the other ones, through a matrix.
    shapes : int
        How many betas shape it.
    """

    has_face: bool
    has_arkit_slots: bool
    has_matrix: bool
    shapes: int


def not_shown(clip: MotionClip, body: BodyAbilities) -> tuple[str, ...]:
    """Return a sentence for each thing in `clip` that a body with these abilities cannot show."""
    return tuple(chain(_of_expression(clip, body), _of_shape(clip, body)))


def _of_expression(clip: MotionClip, body: BodyAbilities) -> tuple[str, ...]:
    """Say where the face stays still although the clip moves it.

    ARKit weights and SMPL-X's expression coefficients are different spaces; a body has slots for
    one of them, and neither is guessed from the other.
    """
    faces = {name: getattr(clip, name) for name in _NAMES}
    moving = [name for name, face in faces.items() if face is not None and np.any(face)]
    if not body.has_face:
        if not moving and not clip.poses[:, _FACE].any():
            return ()
        return (
            "the clip moves its face, and this body has none: nothing of expression, jaw and eyes "
            "is shown (choose an avatar with a face)",
        )
    wanted = "arkit" if body.has_arkit_slots else "expressions"
    if not moving or faces[wanted] is not None or body.has_matrix:
        return ()
    return (
        f"the clip's face is given as {_NAMES[moving[0]]}, which this body has no slots for; its "
        f"face moves by jaw and eyes alone (name a matrix to {_NAMES[wanted]} as "
        "video.expression_matrix, or choose another body)",
    )


def _of_shape(clip: MotionClip, body: BodyAbilities) -> tuple[str, ...]:
    """Say where the body has another shape than the clip gives."""
    shown = body.shapes
    if not np.any(clip.betas[shown:]):
        return ()
    if shown:
        return (f"only the first {shown} of the clip's {len(clip.betas)} betas shape this body",)
    return (
        "the clip gives a body shape (betas), which this body does not take on (name a licensed "
        "SMPL-X model as video.body to show it)",
    )
