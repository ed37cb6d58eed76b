"""An avatar's body in a compact encoding: mesh, skin, face, joints."""

from __future__ import annotations

from functools import lru_cache
from typing import Final

import numpy as np

from motion.body.model import BodyModel, read_body
from motion.body.skinning import four_strongest
from motion.body.surface import VertexNormals, surface_colours
from motion.skeleton import PARENTS
from renderer.look import default_body
from renderer.viewer.packing import pack, quantise

_STEP: Final = 5e-5
"""Metres: five hundredths of a millimetre."""
_FACE_STEP: Final = 2e-5
_NORMAL_STEP: Final = 1 / 127


@lru_cache(maxsize=2)
def avatar_body(avatar: str) -> BodyModel:
    """Return the body of an avatar."""
    return read_body(default_body(avatar))


@lru_cache(maxsize=2)
def packed_avatar(avatar: str) -> bytes:
    """Return an avatar's body, to be read by ``viewer.js``.

    Each vertex follows the four joints that it follows most. Of each expression only those
    vertices are kept that it moves.
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
