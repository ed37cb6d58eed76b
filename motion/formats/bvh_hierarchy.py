"""The skeleton that a BVH file describes before its motion."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from motion.errors import InputError

_CHANNELS: Final = frozenset(f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation"))
_END_SITE: Final = -1

MOST_JOINTS: Final = 2000
"""More than any body has with fingers, face and clothes; each costs time at every frame."""


@dataclass(frozen=True, kw_only=True)
class BvhJoint:
    """One joint of a BVH skeleton.

    Attributes
    ----------
    name : str
        Its name in the file.
    parent : int
        Index of its parent among the joints; -1 for the root.
    offset : tuple of float
        Where it lies in its parent's frame when nothing is turned, in the file's length unit.
    channels : tuple of str
        Its columns in the order in which they apply, such as ``Zrotation``.
    """

    name: str
    parent: int
    offset: tuple[float, float, float]
    channels: tuple[str, ...]


def parse_hierarchy(lines: list[tuple[int, str]], path: Path) -> tuple[BvhJoint, ...]:
    """Return the joints that the lines between HIERARCHY and MOTION describe.

    Parameters
    ----------
    lines : list of (int, str)
        Line numbers and their text, without blank lines.
    path : Path
        The file, for messages.

    Raises
    ------
    InputError
        At the first line that does not fit, or where the skeleton ends early.
    """
    drafts: list[BvhJoint] = []
    # Blocks that are open, and the one that the next brace opens: a joint's index, or _END_SITE.
    blocks: list[int] = []
    announced: int | None = None
    for number, line in _statements(lines):
        where = f"{path}, line {number}"
        words = line.split()
        keyword = words[0].upper()
        inside = blocks[-1] if blocks else None
        in_joint = inside is not None and inside != _END_SITE
        fits = announced is None
        if keyword == "{":
            fits = announced is not None
            if announced is not None:
                blocks.append(announced)
            announced = None
        elif keyword in ("ROOT", "JOINT"):
            fits &= len(words) > 1 and (in_joint if keyword == "JOINT" else not drafts)
            if len(drafts) == MOST_JOINTS:
                raise InputError(
                    f"the skeleton has more than {MOST_JOINTS} joints",
                    where=where,
                    remedy="Export the joints of the body alone",
                )
            announced = len(drafts)
            parent = -1 if inside is None else inside
            drafts.append(
                BvhJoint(name=" ".join(words[1:]), parent=parent, offset=(0, 0, 0), channels=())
            )
        elif keyword == "END":
            fits &= in_joint
            announced = _END_SITE
        elif keyword == "}":
            fits &= bool(blocks)
            blocks = blocks[:-1]
        elif keyword == "OFFSET" and inside is not None:
            offset = _offset(words, where)
            if in_joint:
                drafts[inside] = replace(drafts[inside], offset=offset)
        elif keyword == "CHANNELS" and inside is not None and in_joint:
            drafts[inside] = replace(drafts[inside], channels=_channels(words, where))
        else:
            fits = False
        if not fits:
            raise InputError(
                f"{line!r} does not fit here",
                where=where,
                remedy="Repair the line or export again",
            )
    names = [joint.name for joint in drafts]
    twice = sorted({name for name in names if names.count(name) > 1})
    if blocks or announced is not None or not drafts or twice:
        what = f"joint {twice[0]!r} occurs twice" if twice else "the skeleton is not complete"
        raise InputError(what, where=path, remedy="Export the file again")
    return tuple(drafts)


def _statements(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yield statements with their line numbers, braces on their own."""
    for number, line in lines:
        for part in re.split(r"([{}])", line):
            if part.strip():
                yield number, part.strip()


def _offset(words: list[str], where: str) -> tuple[float, float, float]:
    try:
        x, y, z = (float(word) for word in words[1:])
    except ValueError as error:
        raise InputError(
            f"{' '.join(words)!r} is not an offset of three numbers",
            where=where,
            remedy="Repair it",
        ) from error
    if not np.isfinite([x, y, z]).all():
        raise InputError("the offset is not finite", where=where, remedy="Repair it")
    return x, y, z


def _channels(words: list[str], where: str) -> tuple[str, ...]:
    names = tuple(word[:1].upper() + word[1:].lower() for word in words[2:])
    unknown = [name for name in names if name not in _CHANNELS]
    if words[1:2] != [str(len(names))] or unknown or len(set(names)) != len(names):
        raise InputError(
            f"{' '.join(words)!r} is not a list of channels",
            where=where,
            remedy="Give their number, then names such as Xposition or Zrotation",
        )
    return names
