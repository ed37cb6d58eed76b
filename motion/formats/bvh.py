"""Reading BVH motion capture files of any skeleton."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from decimal import Decimal, InvalidOperation
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
    header, rows = lines[motion_at + 1 : motion_at + 3], lines[motion_at + 3 :]
    frames = _header_value(header, 0, r"Frames:\s*(\d{1,12})", "'Frames: <number>'", path)
    frame_time = _header_value(header, 1, r"Frame Time:\s*(\S+)", "'Frame Time: <seconds>'", path)
    header_rate = _rate_of(frame_time, f"{path}, line {header[1][0]}")
    values = _parse_rows(rows, sum(len(joint.channels) for joint in joints), path)
    notes: tuple[str, ...] = ()
    if int(frames) != len(values):
        contradiction = _contradiction(int(frames), header_rate, len(values))
        if frame_rate is None:
            raise BvhFrameCountError(
                contradiction,
                where=path,
                rows=len(values),
                frame_rates=_possible_rates(int(frames), header_rate, len(values)),
            )
        notes = (f"{contradiction}; read at {frame_rate:g} per second",)
    return BvhMotion(
        joints=joints,
        values=values,
        frame_rate=header_rate if frame_rate is None else frame_rate,
        notes=notes,
    )


def _header_value(
    header: list[tuple[int, str]], index: int, pattern: str, form: str, path: Path
) -> str:
    match = re.fullmatch(pattern, header[index][1], re.IGNORECASE) if index < len(header) else None
    if match is None:
        where = f"{path}, line {header[index][0]}" if index < len(header) else path
        raise InputError(
            f"the motion's header lacks {form}", where=where, remedy="Repair or export again"
        )
    return match[1]


def _rate_of(frame_time: str, where: str) -> float:
    """Return the frame rate of a rounded frame time.

    It is a whole number if that number is a common rate, or if the digits distinguish it from its
    neighbours, as 0.033 distinguishes 30 from 29 and 31. Otherwise the frame time is taken
    literally: 0.03 is 33.33.
    """
    try:
        seconds = Decimal(frame_time)
    except InvalidOperation as error:
        raise InputError(
            f"frame time {frame_time!r} is not a number", where=where, remedy="Give seconds"
        ) from error
    if not seconds.is_finite() or not _SHORTEST_FRAME <= seconds <= _LONGEST_FRAME:
        raise InputError(f"frame time {frame_time} is not usable", where=where, remedy="Repair it")
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
        where = f"{path}, line {number}"
        cells = line.split()
        if len(cells) != width:
            raise InputError(
                f"the row has {len(cells)} values, the skeleton has {width} channels",
                where=where,
                remedy="Repair the row; a last row that is too short means a truncated file",
            )
        try:
            values[index] = [float(cell) for cell in cells]
        except ValueError as error:
            raise InputError(
                f"the row holds a word that is not a number ({error})",
                where=where,
                remedy="Repair the row",
            ) from error
        if not np.isfinite(values[index]).all():
            raise InputError(
                "the row holds a value that is not finite",
                where=where,
                remedy="Repair or remove the row",
            )
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
    announced: int | None = None
    for number, line in _statements(lines):
        where = f"{path}, line {number}"
        words = line.split()
        keyword = words[0].upper()
        block = blocks[-1] if blocks else None
        in_joint = block is not None and block != _END_SITE
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
            parent = -1 if block is None else block
            drafts.append(
                BvhJoint(name=" ".join(words[1:]), parent=parent, offset=(0, 0, 0), channels=())
            )
        elif keyword == "END":
            fits &= in_joint
            announced = _END_SITE
        elif keyword == "}":
            fits &= bool(blocks)
            blocks = blocks[:-1]
        elif keyword == "OFFSET" and block is not None:
            offset = _offset(words, where)
            if in_joint:
                drafts[block] = replace(drafts[block], offset=offset)
        elif keyword == "CHANNELS" and block is not None and in_joint:
            drafts[block] = replace(drafts[block], channels=_channels(words, where))
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
        problem = f"joint {twice[0]!r} occurs twice" if twice else "the skeleton is not complete"
        raise InputError(problem, where=path, remedy="Export the file again")
    return tuple(drafts)


def _statements(lines: list[tuple[int, str]]) -> Iterator[tuple[int, str]]:
    """Yield statements with their line numbers; each brace is a statement."""
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
