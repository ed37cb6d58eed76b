"""Compact encodings for browsers: an avatar's body, a motion clip, and the integers of both.

Consecutive values of motion and of meshes differ little. So differences are stored, most of which
need only their low byte; deflate compresses the zero high bytes to almost nothing. Browsers can
inflate without a library.
"""

import json
import zlib
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.body.model import BodyModel, read_body
from motion.body.skinning import four_strongest
from motion.body.surface import VertexNormals, surface_colours
from motion.clip import MotionClip
from motion.skeleton import PARENTS
from renderer.look import default_body

LARGEST: Final = 32_767
"""Largest integer of packed values; the smallest is its negative."""


def quantise(values: NDArray[np.floating], step: float) -> tuple[NDArray[np.int16], float]:
    """Return `values` as integer multiples of a step, and the step.

    Parameters
    ----------
    values : ndarray
        Finite numbers.
    step : float
        The requested step; it is enlarged if the values would not fit.

    Returns
    -------
    (ndarray of int16, float)
        The quantised values, in the same shape, and the step; errors are at most half a step.
    """
    step = max(step, float(np.abs(values).max(initial=0)) / LARGEST)
    return np.round(values / step).astype(np.int16), step


def pack(facts: Mapping[str, Any], arrays: Mapping[str, NDArray[np.integer]]) -> bytes:
    """Return facts and arrays as zlib data.

    The content is the length of a header as four bytes, little-endian; the header in JSON, with the
    facts and, under ``arrays``, name, rows and columns of each array; then the arrays. Each is
    written column by column as differences from the previous row modulo 65,536, zigzag-encoded (0,
    -1, 1, -2 … become 0, 1, 2, 3 …): all low bytes, then all high bytes.

    Parameters
    ----------
    facts : mapping
        JSON values.
    arrays : mapping of str to ndarray
        Shape (rows, columns), values from -32,767 to 65,535.
    """
    shapes = [[name, *values.shape] for name, values in arrays.items()]
    header = json.dumps({**facts, "arrays": shapes}, separators=(",", ":")).encode()
    chunks = [len(header).to_bytes(4, "little"), header]
    for values in arrays.values():
        differences = np.diff(values.astype(np.uint16), axis=0, prepend=np.uint16(0))
        signed = differences.view(np.int16).T
        folded = ((signed << 1) ^ (signed >> 15)).view(np.uint16)
        chunks += [part.astype(np.uint8).tobytes() for part in (folded & 0xFF, folded >> 8)]
    return zlib.compress(b"".join(chunks), level=9)


_STEP: Final = 5e-5
"""Step of vertices in metres: 0.05 mm."""
_FACE_STEP: Final = 2e-5
_NORMAL_STEP: Final = 1 / 127


@lru_cache(maxsize=2)
def avatar_body(avatar: str) -> BodyModel:
    """Return the body of an avatar."""
    return read_body(default_body(avatar))


@lru_cache(maxsize=2)
def packed_avatar(avatar: str) -> bytes:
    """Return an avatar's body in the format of ``viewer.js``.

    Each vertex has its four largest skin weights. Each expression has only the vertices that it
    moves.
    """
    body = avatar_body(avatar)
    no_betas = np.zeros(0)
    vertices, step = quantise(body.template, _STEP)
    joints, weights = four_strongest(body.weights)
    is_moved = np.abs(body.expression_directions).max(axis=1) > _FACE_STEP / 2
    slots, moved_vertices = np.nonzero(is_moved.T)
    moves, face_step = quantise(
        body.expression_directions[moved_vertices, :, slots].reshape(-1, 3), _FACE_STEP
    )
    twist = body.twist_joints
    return pack(
        {
            "parents": PARENTS,
            "joints": np.round(body.joints(no_betas), 5).tolist(),
            "bones": [] if twist is None else twist.bones.tolist(),
            "shares": [] if twist is None else twist.shares.tolist(),
            "expressions": body.expression_directions.shape[2],
            "ground": float(vertices[:, 1].min() * step),
            "steps": {"vertices": step, "moves": face_step, "normals": _NORMAL_STEP},
        },
        {
            "vertices": vertices,
            "normals": quantise(VertexNormals(body).of(body.template), _NORMAL_STEP)[0],
            "colours": np.round(surface_colours(body)[:, :3] * 255).astype(np.int16),
            "faces": body.faces,
            "skinJoints": joints,
            "skinWeights": np.round(weights * 255).astype(np.int16),
            "movedVertices": np.stack([slots, moved_vertices], axis=1),
            "moves": moves,
        },
    )


TURN_STEP: Final = 8e-4
"""Step of axis-angle vectors in radians. The error of a rotation is at most that of its vector,
half a step along each axis: 0.0397 degrees."""

_SHIFT_STEP: Final = 1e-4
_WEIGHT_STEP: Final = 0.004


def track(clip: MotionClip, body: BodyModel) -> bytes:
    """Return the track of `clip` on `body` in the format of ``viewer.js``.

    Parameters
    ----------
    clip : MotionClip
        The motion.
    body : BodyModel
        The body, which converts the clip's face.

    Returns
    -------
    bytes
        Data of `pack`: joints' axis-angle vectors, shape (T, 165), the body's translation, (T, 3),
        and weights of the body's expressions, (T, E), each in the steps given by the facts.
    """
    turns = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float)).as_rotvec()
    stepped = {
        "turns": quantise(turns.reshape(len(clip), -1), TURN_STEP),
        "shifts": quantise(clip.trans, _SHIFT_STEP),
        "weights": quantise(body.expression_weights(clip), _WEIGHT_STEP),
    }
    return pack(
        {
            "rate": clip.frame_rate,
            "steps": {name: step for name, (_, step) in stepped.items()},
        },
        {name: numbers for name, (numbers, _) in stepped.items()},
    )
