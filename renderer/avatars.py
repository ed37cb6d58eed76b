"""The avatars that a study can show. `tools.avatars` makes their files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Final

from motion.errors import InputError

BODIES: Final = Path(__file__).parent / "bodies"


@dataclass(frozen=True, kw_only=True)
class Avatar:
    """One avatar.

    Attributes
    ----------
    name : str
        As `study.toml` names it.
    description : str
        One line for people who choose.
    has_face : bool
        Whether it has eyes, brows and a mouth, and shows facial expression.
    """

    name: str
    description: str
    has_face: bool = True

    @property
    def body(self) -> Path:
        """File of its body, in SMPL-X's ``.npz`` layout."""
        # smplx recognises a model file by how its name starts.
        return BODIES / f"smplx_anny_{self.name}.npz"


_AVATARS: Final = (
    Avatar(name="alex", description="slim, light skin, short brown hair, blue sweater"),
    Avatar(name="maya", description="woman with light brown skin and a dark bob, in a jacket"),
    Avatar(
        name="jonas",
        description="man with light skin, brown hair and a short beard, in a light-blue shirt",
    ),
    Avatar(
        name="amara",
        description="woman with dark skin and a bun, in a T-shirt with bare forearms",
    ),
    Avatar(
        name="henry",
        description="older man with grey hair and glasses, in a sweater over a shirt",
    ),
    Avatar(
        name="mannequin",
        description="neutral figure of one colour, without a face",
        has_face=False,
    ),
)

AVATARS: Final[Mapping[str, Avatar]] = MappingProxyType({each.name: each for each in _AVATARS})
"""All avatars by name; the first is the one shown where none is chosen."""

FIRST: Final = _AVATARS[0].name


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


def default_body(avatar: str = FIRST) -> Path:
    """Return the file of an avatar's body, in SMPL-X's ``.npz`` layout.

    Raises
    ------
    InputError
        If there is no such avatar.
    """
    return avatar_named(avatar).body
