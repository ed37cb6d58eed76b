"""The people whom a study can show: what each looks like, as data.

Light to import: a body is built from this by `renderer.avatar.assembly`, and only when needed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from motion.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Avatar:
    """What one avatar looks like.

    Attributes
    ----------
    name : str
        As `study.toml` names it.
    description : str
        One line for people who choose.
    height : float
        Standing height without hair and shoes, in metres.
    phenotype : mapping of str to float
        Anny's labels (gender, age, muscle, weight, ...), each in [0, 1]; 0.5 where not given.
    palette : mapping of str to str
        sRGB colours (``#rrggbb``) by material; `COMMON_COLOURS` where not given.
    has_face : bool
        Whether it has eyes, brows and a mouth, and shows facial expression.
    """

    name: str
    description: str
    height: float
    phenotype: Mapping[str, float]
    palette: Mapping[str, str] = field(default_factory=dict)
    has_face: bool = True


COMMON_COLOURS: Final[Mapping[str, str]] = MappingProxyType({
    "teeth": "#ece7dd", "tongue": "#b06060", "mouth": "#5a2222", "sclera": "#f1efec",
    "pupil": "#0a0a0a", "lash": "#241a16", "soles": "#dcdcd8",
})  # fmt: skip

_PEOPLE: Final = (
    Avatar(
        name="alex",
        description="slim, light skin, short brown hair, blue sweater",
        height=1.74,
        phenotype={
            "gender": 0.25, "age": 0.70, "height": 0.5, "muscle": 0.5, "weight": 0.45,
            "proportions": 0.6,
        },
        palette={
            "skin": "#dfab8e", "lips": "#c08472", "nails": "#e5b5a0", "iris": "#5b412c",
            "limbus": "#33241a", "brow": "#4d392b", "hair": "#3a2a1f", "sweater": "#3f6690",
            "trim": "#37597e", "trousers": "#343841", "shoes": "#4a4542",
        },
    ),
    Avatar(
        name="mannequin",
        description="neutral figure of one colour, without a face",
        height=1.74,
        phenotype={
            "gender": 0.5, "age": 0.67, "height": 0.5, "muscle": 0.5, "weight": 0.45,
            "proportions": 0.6,
        },
        palette=dict.fromkeys((
            "skin", "lips", "nails", "iris", "limbus", "brow", "hair", "sweater", "trim",
            "trousers", "shoes", "teeth", "tongue", "mouth", "sclera", "pupil", "lash", "soles",
        ), "#a8a49f"),
        has_face=False,
    ),
)  # fmt: skip

AVATARS: Final[Mapping[str, Avatar]] = MappingProxyType({each.name: each for each in _PEOPLE})
"""All avatars by name; the first is the one shown where none is chosen."""

FIRST: Final = _PEOPLE[0].name


def avatar_named(name: str) -> Avatar:
    """Return avatar `name`.

    Raises
    ------
    InputError
        If there is none of that name.
    """
    if name not in AVATARS:
        raise InputError(f"there is no avatar {name!r}", remedy=f"Use one of {', '.join(AVATARS)}")
    return AVATARS[name]
