"""Anatomical components of face and upper body, and which of them are neighbours.

Bhattacharya et al. 2024, section 3.3.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from motion.formats.ted_npz import BONES

FloatArray = NDArray[np.float32]
Parts = tuple[tuple[int, ...], ...]

BODY_PARTS: Final[Parts] = ((0, 1, 2), (3, 4, 5), (6, 7, 8))
"""Bones of torso, left and right arm (section 3.3.2)."""

_COMPONENT_OF: Final = {
    "brow": 0, "eye": 0, "cheek": 1, "nose": 1, "mouth": 2, "jaw": 3, "tongue": 3,
}  # fmt: skip
"""Eyes, nose, lips and lower jaw, by how the name of a landmark's facial action begins. The paper
names no brows and cheeks; they go with what lies next to them."""

_CORNERS: Final = ("mouthSmile", "mouthFrown", "mouthDimple", "mouthStretch")
"""Actions of the corners of the lips, which express and are not the phoneme predictor's."""


def components_of(actions: Sequence[str]) -> Parts:
    """Return the landmarks of each anatomical component of the face, by their facial actions."""
    parts: tuple[list[int], ...] = ([], [], [], [])
    for landmark, action in enumerate(actions):
        start = next(start for start in _COMPONENT_OF if action.startswith(start))
        parts[_COMPONENT_OF[start]].append(landmark)
    return tuple(tuple(part) for part in parts)


def lips_of(actions: Sequence[str]) -> tuple[int, ...]:
    """Return the landmarks of the lips without their corners."""
    return tuple(
        landmark
        for landmark, action in enumerate(actions)
        if action.startswith("mouth") and not action.startswith(_CORNERS)
    )


def face_graph(components: Parts, neutral: FloatArray) -> FloatArray:
    """Return which landmarks are neighbours, (L, L) of 0 and 1.

    All of a component are, and each with the nearest one of every other component.
    """
    count = len(neutral)
    edges = np.zeros((count, count), np.float32)
    apart = np.linalg.norm(neutral[:, None] - neutral, axis=-1)
    for own in components:
        edges[np.ix_(own, own)] = 1
        for other in components:
            if other is not own and own and other:
                between = apart[np.ix_(own, other)]
                one, two = np.unravel_index(between.argmin(), between.shape)
                edges[own[one], other[two]] = edges[other[two], own[one]] = 1
    np.fill_diagonal(edges, 0)
    return edges


def bone_graph(hops: int) -> FloatArray:
    """Return which bones are neighbours, (9, 9): those that share a joint, over so many hops."""
    touch = np.array([[bool(set(one) & set(two)) for two in BONES] for one in BONES], np.float32)
    reached = np.linalg.matrix_power(touch, hops) > 0
    edges = reached.astype(np.float32)
    np.fill_diagonal(edges, 0)
    return edges


def component_graph(count: int, *, pose: bool) -> FloatArray:
    """Return which components are neighbours: all of the face; of the body the torso with each."""
    edges = np.ones((count, count), np.float32)
    if pose:
        edges[1:, 1:] = 0
    np.fill_diagonal(edges, 0)
    return edges


BODY_EDGES: Final = component_graph(len(BODY_PARTS), pose=True)
