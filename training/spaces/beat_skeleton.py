"""The figure on which BEAT's joint rotations are told, idealised.

Every speaker of BEAT has a skeleton of their own; they agree in their joints and in how the figure
stands when nothing is turned: upright, arms level, palms down, facing +z, centimetres. Bones are
straight and of round lengths here, because only their directions matter: motion is retargeted to
another body anyway.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

from motion.formats.bvh_hierarchy import BvhJoint

Offset = tuple[float, float, float]

_TURNS: Final = ("Xrotation", "Yrotation", "Zrotation")
_ROOT: Final = ("Xposition", "Yposition", "Zposition", *_TURNS)

_TRUNK: Final[tuple[tuple[str, str, Offset], ...]] = (
    ("Spine", "Hips", (0, 6, -2)),
    ("Spine1", "Spine", (0, 12, -2)),
    ("Spine2", "Spine1", (0, 12, -1)),
    ("Spine3", "Spine2", (0, 12, 0)),
    ("Neck", "Spine3", (0, 16, 2)),
    ("Neck1", "Neck", (0, 4, 0)),
    ("Head", "Neck1", (0, 4, 0)),
)

_ARM: Final[tuple[tuple[str, str, Offset], ...]] = (
    ("Shoulder", "Spine3", (0, 12, 6)),
    ("Arm", "Shoulder", (20, 0, 0)),
    ("ForeArm", "Arm", (30, 0, 0)),
    ("Hand", "ForeArm", (25, 0, 0)),
    ("HandMiddle1", "Hand", (9, 0, 0)),
    ("HandMiddle2", "HandMiddle1", (5, 0, 0)),
    ("HandMiddle3", "HandMiddle2", (3, 0, 0)),
    ("HandRing", "Hand", (0.2, -0.2, -1)),
    ("HandRing1", "HandRing", (8, 0, -0.8)),
    ("HandRing2", "HandRing1", (5, 0, -0.5)),
    ("HandRing3", "HandRing2", (3, 0, -0.3)),
    ("HandPinky", "HandRing", (0.2, -0.2, -1)),
    ("HandPinky1", "HandPinky", (7, 0, -1.5)),
    ("HandPinky2", "HandPinky1", (4, 0, -0.9)),
    ("HandPinky3", "HandPinky2", (2, 0, -0.4)),
    ("HandIndex", "Hand", (0.2, -0.2, 1)),
    ("HandIndex1", "HandIndex", (9, 0, 0.8)),
    ("HandIndex2", "HandIndex1", (5, 0, 0.4)),
    ("HandIndex3", "HandIndex2", (3, 0, 0.2)),
    ("HandThumb1", "HandIndex", (0.2, -0.8, 1)),
    ("HandThumb2", "HandThumb1", (5, 0.8, 2)),
    ("HandThumb3", "HandThumb2", (4, 0.6, 1.6)),
)
"""Of the left arm; the right one is its mirror image."""

_LEG: Final[tuple[tuple[str, str, Offset], ...]] = (
    ("UpLeg", "Hips", (8, 0, 0)),
    ("Leg", "UpLeg", (0, -43, 0)),
    ("Foot", "Leg", (0, -43, 0)),
    ("ToeBase", "Foot", (0, -3, 10)),
)

_TOLD_OF_TRUNK: Final = ("Spine", "Neck", "Neck1")

TOLD_JOINTS: Final = (
    *_TOLD_OF_TRUNK,
    *(f"{side}{name}" for side in ("Right", "Left") for name, *_ in _ARM),
)
"""The 47 joints whose rotations DiffSHEG tells, in its order. Of the others BEAT's prepared files
hold nothing: hips and legs stand still, and the whole spine bends in its lowest joint."""


def _joints() -> Iterator[tuple[str, str, Offset]]:
    yield from _TRUNK
    for side, sign in (("Right", -1), ("Left", 1)):
        for part in (_ARM, _LEG):
            own = {name for name, *_ in part}
            for name, parent, (x, y, z) in part:
                above = f"{side}{parent}" if parent in own else parent
                yield f"{side}{name}", above, (sign * x, y, z)


def _skeleton() -> tuple[BvhJoint, ...]:
    joints = [BvhJoint(name="Hips", parent=-1, offset=(0, 0, 0), channels=_ROOT)]
    places = {"Hips": 0}
    for name, parent, offset in _joints():
        joints.append(BvhJoint(name=name, parent=places[parent], offset=offset, channels=_TURNS))
        places[name] = len(places)
    return tuple(joints)


BEAT_SKELETON: Final = _skeleton()
"""Parents before children; the first is the root."""
