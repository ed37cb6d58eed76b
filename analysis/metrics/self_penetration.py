"""Self-penetration: how deep forearms and hands reach into trunk, head and thighs.

A vertex of a forearm or hand is inside if the surface of trunk, head and thighs winds around it
(generalised winding number above one half; Jacobson et al. 2013, "Robust inside-outside
segmentation using generalized winding numbers"), a test that tolerates open edges of clothes and at
the shoulders. Its depth is its distance from that surface. Upper arms are left out because they
touch trunk and forearms in every pose, and lower legs because gestures do not reach them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
from scipy.spatial import cKDTree

from analysis.metrics.scores import Metric, MetricResult
from motion.arrays import Bools, Floats, Floats32, Ints
from motion.body.model import BodyModel
from motion.clip import MotionClip
from motion.skeleton import JOINT_COUNT, LEFT_HAND_JOINTS, RIGHT_HAND_JOINTS, joint_index

SAMPLES_PER_SECOND: Final = 2.0
"""Sampled frames: a hand that sinks in usually stays for longer than half a second."""

TOLERANCE: Final = 0.005
"""Metres by which skin and clothes give way; a deeper frame counts as penetrated."""

_MOVING: Final = (
    *(f"{side}_{joint}" for side in ("left", "right") for joint in ("elbow", "wrist")),
    *LEFT_HAND_JOINTS,
    *RIGHT_HAND_JOINTS,
)
"""Joints that move the skin of forearms and hands."""

_SOLIDS: Final = (
    ("pelvis", "spine1", "spine2", "spine3", "left_collar", "right_collar"),
    ("neck", "head", "jaw", "left_eye", "right_eye"),
    ("left_hip",),
    ("right_hip",),
)
"""Joints that move the skin of trunk, head and thighs."""

_DIRECTIONS: Final = np.array(
    [d for d in product((-1, 0, 1), repeat=3) if d > (0, 0, 0)], np.float64
)
"""Half of the directions to a cube's faces, edges and corners."""

_INSIDE: Final = 0.5
_NEAREST: Final = 8
"""Triangles with the nearest centres, among which the nearest triangle is sought."""

_POINTS_AT_A_TIME: Final = 64


@dataclass(frozen=True, kw_only=True, eq=False)
class PenetrableBody:
    """A body, with its vertices that can penetrate and those that can be penetrated.

    Attributes
    ----------
    body : BodyModel
        The body.
    moving : ndarray, shape (M,), int
        Vertices of forearms and hands.
    solids : tuple of ndarray, int
        Vertices of trunk, head and each thigh.
    faces : ndarray, shape (F, 3), int
        Triangles of their surface.
    """

    body: BodyModel
    moving: Ints
    solids: tuple[Ints, ...]
    faces: Ints

    @classmethod
    def of(cls, body: BodyModel) -> PenetrableBody:
        """Divide `body` into parts, by the joint that moves each vertex most."""
        joints = _main_joints(body)
        solids = tuple(np.flatnonzero(np.isin(joints, _indices(names))) for names in _SOLIDS)
        is_solid = np.zeros(len(joints), bool)
        is_solid[np.concatenate(solids)] = True
        return cls(
            body=body,
            moving=np.flatnonzero(np.isin(joints, _indices(_MOVING))),
            solids=solids,
            faces=body.faces[is_solid[body.faces].all(axis=1)],
        )

    def depths(self, clip: MotionClip) -> Floats32:
        """Return the depth of the deepest vertex in each sampled frame of `clip`.

        Parameters
        ----------
        clip : MotionClip
            The clip; its shape and face are ignored, so that all clips are on one body.

        Returns
        -------
        ndarray, shape (n,), float32
            Metres; 0 where no vertex is inside.
        """
        poses = MotionClip(poses=clip.poses, trans=clip.trans, frame_rate=clip.frame_rate)
        sampled = self.body.vertices(poses.frames(sampled_frames(len(clip), clip.frame_rate)))
        return np.array([self._depth(vertices) for vertices in sampled], np.float32)

    def _depth(self, vertices: Floats32) -> float:
        """Return the depth of a frame's deepest vertex, in metres."""
        placed = vertices.astype(np.float64)
        points = placed[self.moving]
        points = points[self._within_bounds(placed, points)]
        if not len(points):
            return 0.0
        distances = _distances(points, placed[self.faces])
        deepest_first = np.argsort(-distances, kind="stable")
        for start in range(0, len(points), _POINTS_AT_A_TIME):
            part = deepest_first[start : start + _POINTS_AT_A_TIME]
            inside = winding_numbers(points[part], placed, self.faces) > _INSIDE
            if inside.any():
                return float(distances[part[inside][0]])
        return 0.0

    def _within_bounds(self, placed: Floats, points: Floats) -> Bools:
        """Return which points lie within the bounds of a solid in 26 directions."""
        along = points @ _DIRECTIONS.T
        is_within = np.zeros(len(points), bool)
        for solid in self.solids:
            extent = placed[solid] @ _DIRECTIONS.T
            is_within |= ((along >= extent.min(axis=0)) & (along <= extent.max(axis=0))).all(axis=1)
        return is_within


def sampled_frames(frames: int, frame_rate: float) -> Ints:
    """Return the sampled frames of a clip: the middle one of each half second."""
    count = max(1, math.floor(frames / frame_rate * SAMPLES_PER_SECOND))
    middles = (np.arange(count) + 0.5) * frame_rate / SAMPLES_PER_SECOND
    return np.minimum(middles.astype(np.int64), frames - 1)


def winding_numbers(points: Floats, vertices: Floats, faces: Ints) -> Floats:
    """Return the winding number of a surface around each point: 1 inside, 0 outside.

    Parameters
    ----------
    points : ndarray, shape (Q, 3)
        In metres.
    vertices : ndarray, shape (V, 3)
        Corners of the surface.
    faces : ndarray, shape (F, 3), int
        Its triangles, consistently oriented seen from outside.

    Returns
    -------
    ndarray, shape (Q,)
        Solid angle of all triangles over 4 pi (Van Oosterom & Strackee 1983).
    """
    corners, faces = np.unique(faces, return_inverse=True)
    # Products of points and corners are matrix products; near the origin none cancels.
    centre = vertices[corners].mean(axis=0)
    placed, points = vertices[corners] - centre, points - centre
    a, b, c = (placed[faces[:, corner]] for corner in range(3))
    normals = np.cross(a, b) + np.cross(b, c) + np.cross(c, a)
    volume = np.einsum("fx,fx->f", a, np.cross(b, c)) - points @ normals.T
    square = np.einsum("qx,qx->q", points, points)[:, None]
    along = points @ placed.T
    lengths = np.sqrt(np.maximum(square - 2 * along + np.einsum("vx,vx->v", placed, placed), 0))
    first, second, third = (faces[:, corner] for corner in range(3))

    def dot(start: Ints, end: Ints) -> Floats:
        corners_dot = np.einsum("fx,fx->f", placed[start], placed[end])
        return np.asarray(corners_dot - along[:, start] - along[:, end] + square)

    denominator = (
        lengths[:, first] * lengths[:, second] * lengths[:, third]
        + dot(first, second) * lengths[:, third]
        + dot(second, third) * lengths[:, first]
        + dot(third, first) * lengths[:, second]
    )
    return np.asarray(np.arctan2(volume, denominator).sum(axis=1) / (2 * np.pi))


def self_penetration(depths: Floats32, *, body: str) -> Iterator[MetricResult]:
    """Yield the depth and the share of frames of one clip.

    Parameters
    ----------
    depths : ndarray, shape (n,), n > 0
        In metres, by sampled frame; see `PenetrableBody.depths`.
    body : str
        The body of the clips.

    Yields
    ------
    MetricResult
        The mean over frames of the deepest vertex's depth in mm, 0 if none is inside; and the
        share of frames in which it is deeper than `TOLERANCE`.
    """
    values = np.asarray(depths, np.float64)
    settings = {
        "parts": "forearms and hands inside trunk, head and thighs",
        "inside": "winding number above 0.5",
        "frames": f"{SAMPLES_PER_SECOND:g} per second",
        "body": body,
    }
    yield Metric("self-penetration, depth", "mm", "lower").score(
        1000 * float(values.mean()),
        len(values),
        settings | {"depth": "of the deepest vertex, from the surface"},
    )
    yield Metric("self-penetration, share of frames", better="lower").score(
        float((values > TOLERANCE).mean()),
        len(values),
        settings | {"counted": f"frames deeper than {1000 * TOLERANCE:g} mm"},
    )


def _indices(names: Sequence[str]) -> list[int]:
    return [joint_index(name) for name in names]


def _main_joints(body: BodyModel) -> Ints:
    """Return the joint of the skeleton that moves each vertex most, shape (V,)."""
    weights = body.weights.toarray()
    by_joint = weights[:, :JOINT_COUNT].copy()
    if body.twist_joints is not None:
        for number, (start, _) in enumerate(body.twist_joints.bones):
            by_joint[:, start] += weights[:, JOINT_COUNT + number]
    return np.asarray(by_joint.argmax(axis=1), np.int64)


def _distances(points: Floats, triangles: Floats) -> Floats:
    """Return the points' distances to the nearest of the triangles with the nearest centres."""
    # Imported here: most reports measure no bodies, and this loads a library of meshes.
    from trimesh.triangles import closest_point

    near = cKDTree(triangles.mean(axis=1)).query(points, k=min(_NEAREST, len(triangles)))[1]
    near = near.reshape(len(points), -1)
    repeated = np.repeat(points, near.shape[1], axis=0)
    closest = closest_point(triangles[near.reshape(-1)], repeated)  # type: ignore[no-untyped-call]
    distances = np.linalg.norm(closest - repeated, axis=1).reshape(near.shape)
    return np.asarray(distances.min(axis=1))
