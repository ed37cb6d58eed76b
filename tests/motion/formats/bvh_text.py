"""BVH files for tests: skeletons as text, with rotations of the test's choice."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from motion.formats.bvh import read_bvh
from motion.formats.bvh_motion import BvhMotion

Skeleton = Sequence[tuple[str, str | None, tuple[float, float, float]]]
"""Joints as (name, parent, offset), depth first."""

CHAIN: Skeleton = (
    ("hip", None, (0, 0, 0)),
    ("knee", "hip", (0, -40, 0)),
    ("ankle", "knee", (0, -42, 1)),
)


def bvh_text(
    skeleton: Skeleton,
    rows: np.ndarray,
    *,
    order: str = "ZXY",
    frame_time: str = "0.0333333",
    frames: int | None = None,
) -> str:
    """Return a BVH file; the root has position channels, every joint rotations in `order`."""
    children: Mapping[str | None, list[tuple[str, tuple[float, float, float]]]] = {
        parent: [(name, offset) for name, above, offset in skeleton if above == parent]
        for parent in (None, *(name for name, _, _ in skeleton))
    }
    rotations = " ".join(f"{axis}rotation" for axis in order)

    def block(name: str, offset: tuple[float, float, float], depth: int) -> list[str]:
        lines = [f"{'ROOT' if depth == 0 else 'JOINT'} {name}", "{"]
        lines.append("OFFSET " + " ".join(f"{value:.8f}" for value in offset))
        positions = "6 Xposition Yposition Zposition" if depth == 0 else "3"
        lines.append(f"CHANNELS {positions} {rotations}")
        for child, child_offset in children[name]:
            lines += block(child, child_offset, depth + 1)
        if not children[name]:
            lines += ["End Site", "{", "OFFSET 0 1 0", "}"]
        return [*lines, "}"]

    ((root, offset),) = children[None]
    text = ["HIERARCHY", *block(root, offset, 0), "MOTION"]
    text += [f"Frames: {len(rows) if frames is None else frames}", f"Frame Time: {frame_time}"]
    text += [" ".join(f"{value:.9g}" for value in row) for row in rows]
    return "\n".join(text) + "\n"


def save_bvh_text(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


def read_chain(folder: Path, rows: np.ndarray, **options: Any) -> BvhMotion:
    return read_bvh(save_bvh_text(folder / "a.bvh", bvh_text(CHAIN, rows, **options)))


def columns_of(skeleton: Skeleton, angles: Mapping[str, Sequence[float]]) -> np.ndarray:
    """Return one row with the given rotation angles (in channel order), else zero."""
    row = np.zeros(3 + 3 * len(skeleton))
    order = [name for name, *_ in skeleton]
    for name, values in angles.items():
        first = 3 + 3 * order.index(name)
        row[first : first + 3] = values
    return row
