"""All 75 joints of BEAT's files, in their order.

Beside the joints that move, BEAT's files have ends of limbs that never do.
"""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType
from typing import Final

from motion.formats.bvh_hierarchy import BvhJoint
from training.spaces.beat_skeleton import BEAT_SKELETON

Offset = tuple[float, float, float]

_FINGER_TIPS: Final = MappingProxyType(
    {
        "HandMiddle": (2, 0, 0),
        "HandRing": (2, 0, -0.2),
        "HandPinky": (1.7, 0, -0.4),
        "HandIndex": (1.7, 0, 0.2),
        "HandThumb": (2.2, 0.3, 0.9),
    }
)
"""From the last joint of a left finger to its tip, in centimetres."""

_ENDS: Final = MappingProxyType(
    {
        "Head": ("HeadEnd", (0.0, 10.0, 0.0)),
        **{
            f"{side}{finger}3": (f"{side}{finger}4", (sign * x, y, z))
            for side, sign in (("Right", -1.0), ("Left", 1.0))
            for finger, (x, y, z) in _FINGER_TIPS.items()
        },
        **{f"{side}ToeBase": (f"{side}ToeBaseEnd", (0.0, 0.0, 14.0)) for side in ("Right", "Left")},
    }
)
"""Joint to the end that it carries, and where that lies."""


_LEG: Final = ("UpLeg", "Leg", "Foot", "ToeBase")


def _with_ends() -> tuple[BvhJoint, ...]:
    joints: list[BvhJoint] = []
    places: dict[str, int] = {}

    def add(joint: BvhJoint, parent: str, offset: Offset) -> None:
        above = places[parent] if parent else -1
        places[joint.name] = len(joints)
        joints.append(replace(joint, parent=above, offset=offset))

    # BEAT's files have the legs last.
    for joint in sorted(BEAT_SKELETON, key=lambda joint: joint.name.endswith(_LEG)):
        parent = BEAT_SKELETON[joint.parent].name if joint.parent >= 0 else ""
        offset = joint.offset
        if joint.name.endswith("ToeBase"):
            # BEAT's foot has a joint more, at the height of the toes.
            forefoot = joint.name.replace("ToeBase", "ForeFoot")
            x, y, z = offset
            add(replace(joint, name=forefoot), parent, (x, y, 0.0))
            parent, offset = forefoot, (0.0, 0.0, z)
        add(joint, parent, offset)
        if joint.name in _ENDS:
            name, reach = _ENDS[joint.name]
            add(replace(joint, name=name), joint.name, reach)
    return tuple(joints)


FULL_SKELETON: Final = _with_ends()
"""Parents before children, depth first; the first is the root. Centimetres."""
