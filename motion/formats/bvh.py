"""BVH motion capture files of any skeleton: parsing, and where it puts each joint."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.errors import InputError
from motion.formats.bvh_hierarchy import BvhJoint, parse_hierarchy

FloatArray = NDArray[np.float64]

_ROUNDING: Final = 0.015
"""Share by which the rounding of a frame time may change the frame rate."""
_USUAL_RATES: Final = (24, 25, 30, 48, 50, 60, 90, 100, 120, 144, 200, 240)
"""What a frame time of few digits is taken to be rounded from."""
_LOST_ROWS: Final = 2
"""Rows that thinning out a file may lose at its ends."""

_SHORTEST_FRAME, _LONGEST_FRAME = Decimal("1e-6"), Decimal("1e6")
"""Seconds between which a frame time is a number that somebody may have meant."""


class BvhFrameCountError(InputError):
    """The header of a BVH file promises another number of frames than the file has.

    Attributes
    ----------
    rows : int
        Frames that the file has.
    frame_rates : tuple of float
        Frames per second that may be the true ones: what the header says, and where the rows are
        as many as every second, third, … of the promised frames, what fits them into its duration.
    """

    def __init__(
        self, what: str, *, where: Path, rows: int, frame_rates: tuple[float, ...]
    ) -> None:
        super().__init__(what, where=where, remedy="Give the true frames per second with --fps")
        self.rows = rows
        self.frame_rates = frame_rates


@dataclass(frozen=True, kw_only=True, eq=False)
class BvhMotion:
    """A parsed BVH file.

    Attributes
    ----------
    joints : tuple of BvhJoint
        Parents before children.
    values : ndarray, shape (T, C)
        One column a channel, in joint order: degrees and length units.
    frame_rate : float
        Frames per second.
    calibration : ndarray, shape (C,), or None
        Values of a T-pose that the file held as its first row and that is no part of the motion.
    notes : tuple of str
        What was unusual about the file.
    """

    joints: tuple[BvhJoint, ...]
    values: FloatArray
    frame_rate: float
    calibration: FloatArray | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, parents before children."""
        return tuple(joint.name for joint in self.joints)

    @property
    def rest_positions(self) -> FloatArray:
        """Joint positions (J, 3) when nothing is turned, in the file's length unit."""
        positions = np.zeros((len(self.joints), 3))
        for index, joint in enumerate(self.joints):
            if joint.parent >= 0:
                positions[index] = positions[joint.parent] + joint.offset
        return positions

    def columns(self, index: int) -> slice:
        """Return which columns of `values` belong to joint `index`."""
        first = sum(len(joint.channels) for joint in self.joints[:index])
        return slice(first, first + len(self.joints[index].channels))

    def forward_kinematics(self) -> tuple[FloatArray, FloatArray]:
        """Return where each joint is and how it is turned in the world.

        Returns
        -------
        positions : ndarray, shape (T, J, 3)
            In the file's length unit. Position channels take the place of the offset.
        rotations : ndarray, shape (T, J, 3, 3)
            World rotation matrices.
        """
        frames, count = len(self.values), len(self.joints)
        positions = np.empty((frames, count, 3))
        rotations = np.empty((frames, count, 3, 3))
        for index, joint in enumerate(self.joints):
            local, turn = self._local(index)
            if joint.parent < 0:
                positions[:, index], rotations[:, index] = local, turn
                continue
            above = rotations[:, joint.parent]
            positions[:, index] = positions[:, joint.parent] + np.einsum("tij,tj->ti", above, local)
            rotations[:, index] = above @ turn
        return positions, rotations

    def local_rotations(self) -> FloatArray:
        """Return how each joint is turned relative to its parent, shape (T, J, 3, 3)."""
        return np.stack([self._local(index)[1] for index in range(len(self.joints))], axis=1)

    def _local(self, index: int) -> tuple[FloatArray, FloatArray]:
        """Return the position (T, 3) and rotation (T, 3, 3) of a joint in its parent's frame."""
        joint = self.joints[index]
        values = self.values[:, self.columns(index)]
        position = np.tile(np.array(joint.offset), (len(values), 1))
        axes, angles = "", []
        for column, channel in enumerate(joint.channels):
            if channel.endswith("position"):
                position[:, "XYZ".index(channel[0])] = values[:, column]
            else:
                axes += channel[0]
                angles.append(values[:, column])
        if not axes:
            return position, np.tile(np.eye(3), (len(values), 1, 1))
        turns = Rotation.from_euler(axes, np.stack(angles, axis=1), degrees=True)
        return position, turns.as_matrix()


def read_bvh(path: Path, *, frame_rate: float | None = None) -> BvhMotion:
    """Parse a BVH file.

    Parameters
    ----------
    path : Path
        The file.
    frame_rate : float, optional
        Frames per second; overrides the file's frame time, and accepts a file whose number of
        frames is not what its header says.

    Raises
    ------
    InputError
        If the file is not a BVH, a row has the wrong number of columns or holds no finite
        numbers, or the header contradicts the rows and no `frame_rate` is given
        (`BvhFrameCountError`). The message names file and line.
    """
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as error:
        raise InputError("the file cannot be read", where=path, remedy="Check the path") from error
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
    found = re.fullmatch(pattern, header[index][1], re.IGNORECASE) if index < len(header) else None
    if found is None:
        where = f"{path}, line {header[index][0]}" if index < len(header) else path
        raise InputError(
            f"the motion's header lacks {form}", where=where, remedy="Repair or export again"
        )
    return found[1]


def _rate_of(frame_time: str, where: str) -> float:
    """Return the frame rate that a frame time, rounded to its digits, stands for.

    It is a whole number where the digits tell that number from its neighbours, as 0.033 tells 30
    from 29 and 31, or where it is usual. Else the frame time means what it says: 0.03 is 33.33.
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
    whole = max(1, round(1 / seconds))
    rounded = abs(1 / Decimal(whole) - seconds) <= last_digit
    close = rounded and abs(whole * seconds - 1) <= _ROUNDING
    told = whole in _USUAL_RATES or last_digit * whole**2 < 1
    return float(whole if close and told else 1 / seconds)


def _contradiction(promised: int, rate: float, rows: int) -> str:
    """Return what header and rows say, and the frame rate if the header's duration is right."""
    seconds = promised / rate
    implied = f", which over that time would be {rows / seconds:.4g} per second" if promised else ""
    return (
        f"the header says {promised} frames at {rate:.6g} per second ({seconds:.2f} s), the file "
        f"has {rows} rows{implied}"
    )


def _possible_rates(promised: int, rate: float, rows: int) -> tuple[float, ...]:
    every = round(promised / rows)
    thinned = every > 1 and abs(promised / every - rows) <= _LOST_ROWS
    return (rate, rate / every) if thinned else (rate,)


def _parse_rows(rows: list[tuple[int, str]], width: int, path: Path) -> FloatArray:
    """Return all rows as numbers."""
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
