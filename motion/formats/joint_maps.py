"""Maps from SMPL-X joints to those of other skeletons.

A joint map gives, for each SMPL-X joint name, the name of the source joint whose world rotation it
follows. SMPL-X joints that a map leaves out follow their parent.
"""

import re
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Final

from pydantic import TypeAdapter, ValidationError

from motion.errors import InputError
from motion.skeleton import FINGER_NAMES, JOINT_NAMES

JointMap = Mapping[str, str]
_OWN_MAP: Final = TypeAdapter(dict[str, str])

_SIDES: Final = ("left", "right")

REQUIRED_JOINTS: Final = (
    "pelvis",
    "spine3",
    "head",
    *(f"{side}_{part}" for side in _SIDES for part in ("shoulder", "elbow", "wrist")),
)
"""SMPL-X joints that a skeleton needs for gestures."""

_LEG_JOINTS: Final = tuple(f"{side}_{part}" for side in _SIDES for part in ("hip", "knee", "ankle"))


_TRUNK: Final = ("pelvis", "spine1", "spine2", "spine3", "neck", "head")
_LIMBS: Final = ("collar", "shoulder", "elbow", "wrist", "hip", "knee", "ankle", "foot")
_FINGER_JOINTS: Final = tuple(
    f"{finger}{number}" for finger in FINGER_NAMES for number in (1, 2, 3)
)


def _joint_map(trunk: str, limbs: str, pattern: str, *, finger: str = "") -> JointMap:
    """Return the map for the given names of trunk and limbs, in the order of `_TRUNK` and `_LIMBS`.

    `pattern` makes a name of a part and a side, which is `side` or its first letter `s`. `finger`
    makes a part of a finger's joint, which is our `joint` or, with a capital, `Joint`.
    """
    parts = dict(zip(_LIMBS, limbs.split(), strict=False))
    if finger:
        parts |= {name: finger.format(joint=name, Joint=name.title()) for name in _FINGER_JOINTS}
    names = dict(zip(_TRUNK, trunk.split(), strict=True))
    for side in _SIDES:
        for joint, part in parts.items():
            names[f"{side}_{joint}"] = pattern.format(side=side.title(), s=side[0], part=part)
    return MappingProxyType(names)


def _motion_builder(spine: str) -> JointMap:
    """Return the map of the names that MotionBuilder made common, with the given spine."""
    limbs = "Shoulder Arm ForeArm Hand UpLeg Leg Foot ToeBase"
    return _joint_map(f"Hips {spine} Neck Head", limbs, "{side}{part}", finger="Hand{Joint}")


JOINT_MAPS: Final[Mapping[str, JointMap]] = {
    "beat": _motion_builder("Spine Spine2 Spine3"),
    "mixamo": _motion_builder("Spine Spine1 Spine2"),
    "cmu": _motion_builder("LowerBack Spine Spine1"),
    "genea": _joint_map(
        "b_root b_spine0 b_spine2 b_spine3 b_neck0 b_head",
        "shoulder arm forearm wrist upleg leg foot",
        "b_{s}_{part}",
        finger="{joint}",
    ),
    "anatomical": _joint_map(
        "Hips Chest Chest2 Chest4 Neck Head",
        "Collar Shoulder Elbow Wrist Hip Knee Ankle Toe",
        "{side}{part}",
    ),
    "smplx": MappingProxyType({name: name for name in JOINT_NAMES}),
}
"""Known skeletons: BEAT and ZeroEGGS (four spine joints), Mixamo (three), CMU, GENEA and
Talking With Hands, names after the anatomical joints, and SMPL-X's own names."""


def choose_joint_map(joint_names: Collection[str]) -> tuple[str, JointMap]:
    """Return the name and the map that fit a skeleton, reduced to the joints it has.

    Parameters
    ----------
    joint_names : collection of str
        The skeleton's joints; a namespace, as in ``mixamorig:Hips``, is ignored.

    Returns
    -------
    name : str
        Key of `JOINT_MAPS`.
    joint_map : mapping
        From SMPL-X joints to names in `joint_names`.

    Raises
    ------
    InputError
        If no known map covers the skeleton.
    """
    # Names may begin with a namespace.
    full_names = {re.sub(r"^(.*:|mixamorig\d*_?)", "", name): name for name in joint_names}
    candidates = {
        key: {
            joint: full_names[source] for joint, source in joint_map.items() if source in full_names
        }
        for key, joint_map in JOINT_MAPS.items()
    }
    best = max(candidates, key=lambda key: (not _missing(candidates[key]), len(candidates[key])))
    if not _missing(candidates[best]):
        return best, MappingProxyType(candidates[best])
    unmapped = sorted(set(joint_names) - set(candidates[best].values()))
    raise InputError(
        f"the skeleton is unknown; the nearest known one, {best!r}, leaves "
        f"{', '.join(unmapped)} unmapped and has no joint for "
        f"{', '.join(_missing(candidates[best]))}",
        remedy="Import it on the command line with --joints FILE, which has a line such as "
        """pelvis = "Hips" for each joint: SMPL-X's name, then the one in the motion file""",
    )


def read_joint_map(path: Path) -> JointMap:
    """Read a researcher's own joint map from a TOML file: lines such as ``pelvis = "Hips"``.

    Raises
    ------
    InputError
        If the file has any other content.
    """
    try:
        return _OWN_MAP.validate_python(tomllib.loads(path.read_text("utf-8-sig")))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, ValidationError) as error:
        raise InputError(
            "the file is not a joint map",
            where=path,
            remedy='Give a line such as pelvis = "Hips" for each joint: SMPL-X\'s name, then the '
            "one in the motion file",
        ) from error


def check_joint_map(joint_map: JointMap, joint_names: Collection[str]) -> JointMap:
    """Return a researcher's own `joint_map` if it fits the skeleton, else raise `InputError`."""
    for given, known, owner in (
        (joint_map.keys(), JOINT_NAMES, "SMPL-X"),
        (joint_map.values(), joint_names, "the file"),
    ):
        unknown = sorted(set(given) - set(known))
        if unknown:
            raise InputError(
                f"the joint map names {', '.join(unknown)}, which {owner} does not have",
                remedy=f"Choose among {', '.join(known)}",
            )
    missing = _missing(joint_map)
    if missing:
        raise InputError(
            f"the joint map lacks {', '.join(missing)}",
            remedy=f"Map {', '.join(REQUIRED_JOINTS)}, and all of {', '.join(_LEG_JOINTS)} or none",
        )
    return joint_map


def _missing(joint_map: JointMap) -> tuple[str, ...]:
    """Return the missing joints of a map: required ones, and the rest of incomplete legs."""
    legs = _LEG_JOINTS if any(joint in joint_map for joint in _LEG_JOINTS) else ()
    return tuple(joint for joint in (*REQUIRED_JOINTS, *legs) if joint not in joint_map)
