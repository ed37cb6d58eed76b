"""Reading BVH motion capture files of any skeleton."""

import re
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal
from pathlib import Path
from typing import Final

import numpy as np

from motion.arrays import Floats
from motion.errors import InputError
from motion.formats.bvh_motion import BvhJoint, BvhMotion

_CHANNELS: Final = frozenset(f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation"))
_END_SITE: Final = -1

MOST_JOINTS: Final = 2000
"""More joints than any body has with fingers, face and clothes; each costs time in every frame."""

_ROUNDING: Final = 0.015
"""Largest relative change of the frame rate by the rounding of a frame time."""
_USUAL_RATES: Final = (24, 25, 30, 48, 50, 60, 90, 100, 120, 144, 200, 240)
"""Frame rates to which a frame time of few digits probably belongs."""
_LOST_ROWS: Final = 2
"""Rows that downsampling a file may lose at its ends."""

_HEADER: Final = re.compile(
    r"Frames:\s*(\d{1,12})\nFrame Time:\s*((?:\d+\.?\d*|\.\d+)(?:E[+-]?\d{1,3})?)", re.IGNORECASE
)
_SHORTEST_FRAME, _LONGEST_FRAME = Decimal("1e-6"), Decimal("1e6")
"""Smallest and largest plausible frame time in seconds."""


class BvhFrameCountError(InputError):
    """The header of a BVH file declares another number of frames than the file has.

    Attributes
    ----------
    rows : int
        Frames that the file has.
    frame_rates : tuple of float
        Possible true frame rates: the header's; and, if the rows are every second, third, … of the
        declared frames, the rate that gives them the declared duration.
    """

    def __init__(
        self, what: str, *, where: Path, rows: int, frame_rates: tuple[float, ...]
    ) -> None:
        super().__init__(what, where=where, remedy="State the true frame rate (--fps)")
        self.rows = rows
        self.frame_rates = frame_rates


def read_bvh(path: Path, *, frame_rate: float | None = None) -> BvhMotion:
    """Parse a BVH file.

    Parameters
    ----------
    path : Path
        The file.
    frame_rate : float, optional
        Frames per second; overrides the file's frame time, and lets the header's number of frames
        differ from the file's.

    Raises
    ------
    InputError
        If the file is not a BVH, a row has the wrong number of columns or a value that is not a
        finite number, or the header contradicts the rows and no `frame_rate` is given
        (`BvhFrameCountError`). The message names file and line.
    """
    path = Path(path)
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    lines = [(number, line.strip()) for number, line in enumerate(text.splitlines(), start=1)]
    lines = [(number, line) for number, line in lines if line]
    motion_at = next(
        (place for place, (_, line) in enumerate(lines) if line.upper() == "MOTION"), None
    )
    if not lines or lines[0][1].upper() != "HIERARCHY" or motion_at is None:
        raise InputError(
            "the file is not a BVH file: it has no HIERARCHY followed by MOTION",
            where=path,
            remedy="Give a BVH file, or export the motion again",
        )
    joints = parse_hierarchy(lines[1:motion_at], path)
    header = lines[motion_at + 1 : motion_at + 3]
    frames, header_rate = _parse_header(header, f"{path}, line {lines[motion_at][0]}")
    width = sum(len(joint.channels) for joint in joints)
    values = _parse_rows(lines[motion_at + 3 :], width, path)
    notes: tuple[str, ...] = ()
    if frames != len(values):
        contradiction = _contradiction(frames, header_rate, len(values))
        if frame_rate is None:
            raise BvhFrameCountError(
                contradiction,
                where=path,
                rows=len(values),
                frame_rates=_possible_rates(frames, header_rate, len(values)),
            )
        notes = (f"{contradiction}; read at {frame_rate:g} per second",)
    return BvhMotion(
        joints=joints,
        values=values,
        frame_rate=header_rate if frame_rate is None else frame_rate,
        notes=notes,
    )


def _parse_header(header: list[tuple[int, str]], where: str) -> tuple[int, float]:
    """Return the declared number of frames, and the frame rate."""
    match = _HEADER.fullmatch("\n".join(line for _, line in header))
    if match is not None and _SHORTEST_FRAME <= Decimal(match[2]) <= _LONGEST_FRAME:
        return int(match[1]), _rate_of(Decimal(match[2]))
    raise InputError(
        "'Frames: <number>' and a usable 'Frame Time: <seconds>' do not follow",
        where=where,
        remedy="Repair these two lines, or export the motion again",
    )


def _rate_of(seconds: Decimal) -> float:
    """Return the frame rate of a rounded frame time.

    It is a whole number if that number is a common rate, or if the digits distinguish it from its
    neighbours, as 0.033 distinguishes 30 from 29 and 31. Otherwise the frame time is taken
    literally: 0.03 is 33.33.
    """
    last_digit = Decimal(1).scaleb(int(seconds.as_tuple().exponent))
    nearest_rate = max(1, round(1 / seconds))
    rounded = abs(1 / Decimal(nearest_rate) - seconds) <= last_digit
    close = rounded and abs(nearest_rate * seconds - 1) <= _ROUNDING
    is_distinct = nearest_rate in _USUAL_RATES or last_digit * nearest_rate**2 < 1
    return float(nearest_rate if close and is_distinct else 1 / seconds)


def _contradiction(declared: int, rate: float, rows: int) -> str:
    """Say how header and rows differ, and the frame rate if the header's duration is right."""
    seconds = declared / rate
    implied = f", which over that time would be {rows / seconds:.4g} per second" if declared else ""
    return (
        f"the header says {declared} frames at {rate:.6g} per second ({seconds:.2f} s), the file "
        f"has {rows} rows{implied}"
    )


def _possible_rates(declared: int, rate: float, rows: int) -> tuple[float, ...]:
    step = round(declared / rows)
    thinned = step > 1 and abs(declared / step - rows) <= _LOST_ROWS
    return (rate, rate / step) if thinned else (rate,)


def _parse_rows(rows: list[tuple[int, str]], width: int, path: Path) -> Floats:
    if not rows:
        raise InputError("the motion has no frame", where=path, remedy="Export it again")
    values = np.empty((len(rows), width))
    for index, (number, line) in enumerate(rows):
        try:
            row = [float(cell) for cell in line.split()]
            if len(row) != width or not np.isfinite(row).all():
                raise ValueError
        except ValueError as error:
            raise InputError(
                f"the row does not hold {width} finite numbers, one for each channel",
                where=f"{path}, line {number}",
                remedy="Repair the row; a last row that is too short means a truncated file",
            ) from error
        values[index] = row
    return values


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
        At the first line that does not fit, or if the skeleton ends early.
    """
    drafts: list[BvhJoint] = []
    # The open blocks, and the block that the next brace opens: a joint's index, or _END_SITE.
    blocks: list[int] = []
    announced: list[int] = []
    for number, line in _statements(lines):
        keyword, *words = line.split()
        try:
            _read_statement(keyword.upper(), words, drafts, blocks, announced)
        except (ValueError, IndexError) as error:
            raise InputError(
                f"{line!r} does not fit here",
                where=f"{path}, line {number}",
                remedy="Repair the line or export again",
            ) from error
        if len(drafts) > MOST_JOINTS:
            raise InputError(
                f"the skeleton has more than {MOST_JOINTS} joints",
                where=f"{path}, line {number}",
                remedy="Export the joints of the body alone",
            )
    names = [joint.name for joint in drafts]
    twice = sorted({name for name in names if names.count(name) > 1})
    if blocks or announced or not drafts or twice:
        problem = f"joint {twice[0]!r} occurs twice" if twice else "the skeleton is not complete"
        raise InputError(problem, where=path, remedy="Export the file again")
    return tuple(drafts)


def _read_statement(
    keyword: str,
    words: list[str],
    drafts: list[BvhJoint],
    blocks: list[int],
    announced: list[int],
) -> None:
    """Change the state of `parse_hierarchy` by one statement.

    Raises
    ------
    ValueError or IndexError
        If the statement does not fit the state.
    """
    block = blocks[-1] if blocks else None
    in_joint = block is not None and block != _END_SITE
    if keyword == "{":
        blocks.append(announced.pop())
    elif announced:
        raise ValueError
    elif keyword == "}":
        blocks.pop()
    elif words and (in_joint if keyword == "JOINT" else keyword == "ROOT" and not drafts):
        announced.append(len(drafts))
        parent = -1 if block is None else block
        joint = BvhJoint(name=" ".join(words), parent=parent, offset=(0, 0, 0), channels=())
        drafts.append(joint)
    elif keyword == "END" and in_joint:
        announced.append(_END_SITE)
    elif keyword == "OFFSET" and block is not None:
        x, y, z = map(float, words)
        if not np.isfinite([x, y, z]).all():
            raise ValueError
        if in_joint:
            drafts[block] = replace(drafts[block], offset=(x, y, z))
    elif keyword == "CHANNELS" and block is not None and in_joint:
        names = tuple(word.capitalize() for word in words[1:])
        if words[0] != str(len(names)) or len(set(names) & _CHANNELS) != len(names):
            raise ValueError
        drafts[block] = replace(drafts[block], channels=names)
    else:
        raise ValueError


def _statements(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yield statements with their line numbers; each brace is a statement."""
    for number, line in lines:
        for part in re.split(r"([{}])", line):
            if part.strip():
                yield number, part.strip()
