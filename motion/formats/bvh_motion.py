"""The motion of a BVH file: its skeleton, its joint positions, and writing it.

A motion clip is written as joints and their motion, without face and skin.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from motion.arrays import Floats
from motion.clip import MotionClip
from motion.files import write_text
from motion.skeleton import JOINT_COUNT, JOINT_NAMES, PARENTS

_STILL: Final = 1e-3
"""Change of a channel, in degrees or length units, below which it counts as still."""

_JUMP: Final = 180.0
"""Smallest distance of a calibration pose from the motion, in degrees summed over all joints."""

_JUMP_RATIO: Final = 3.0
"""Ratio of the first change from row to row to the later ones that makes it a jump."""

_NEARLY_ALL: Final = 0.95
"""Quantile of the later changes that counts: a glitch somewhere is no reason to show a T-pose."""

_DECIMALS: Final = 4

_ORDER: Final = "ZXY"
_TURNS: Final = tuple(f"{axis}rotation" for axis in _ORDER)
_ROOT: Final = ("Xposition", "Yposition", "Zposition", *_TURNS)
_CENTIMETRES: Final = 100.0


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
        Its position in its parent's frame at rest, in the file's length unit.
    channels : tuple of str
        Its columns in the order in which they apply, such as ``Zrotation``.
    """

    name: str
    parent: int
    offset: tuple[float, float, float]
    channels: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, eq=False)
class BvhMotion:
    """A parsed BVH file.

    Attributes
    ----------
    joints : tuple of BvhJoint
        Parents before children; the first is the only root.
    values : ndarray, shape (T, C)
        One column per channel, in joint order: degrees and length units.
    frame_rate : float
        Frames per second.
    calibration : ndarray, shape (C,), or None
        Values of a T-pose that was the file's first row and is not part of the motion.
    notes : tuple of str
        Notes on the file.
    """

    joints: tuple[BvhJoint, ...]
    values: Floats
    frame_rate: float
    calibration: Floats | None = None
    notes: tuple[str, ...] = field(default=())

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Names of the joints, parents before children."""
        return tuple(joint.name for joint in self.joints)

    @property
    def rest_positions(self) -> Floats:
        """Joint positions (J, 3) with all rotations zero, in the file's length unit."""
        positions = np.zeros((len(self.joints), 3))
        for index, joint in enumerate(self.joints):
            if joint.parent >= 0:
                positions[index] = positions[joint.parent] + joint.offset
        return positions

    def columns(self, index: int) -> slice:
        """Return the columns of `values` of joint `index`."""
        first = sum(len(joint.channels) for joint in self.joints[:index])
        return slice(first, first + len(self.joints[index].channels))

    def forward_kinematics(self) -> tuple[Floats, Floats]:
        """Return positions and rotations of all joints in the world.

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
            outer = rotations[:, joint.parent]
            positions[:, index] = positions[:, joint.parent] + np.einsum("tij,tj->ti", outer, local)
            rotations[:, index] = outer @ turn
        return positions, rotations

    def local_rotations(self) -> Floats:
        """Return rotations of all joints relative to their parents, shape (T, J, 3, 3)."""
        return np.stack([self._local(index)[1] for index in range(len(self.joints))], axis=1)

    def _local(self, index: int) -> tuple[Floats, Floats]:
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


def settle_first_frame(motion: BvhMotion) -> BvhMotion:
    """Return `motion` without a pose left over in its first row.

    Motion capture software writes the T-pose in which it calibrated the skeleton as the first row;
    it becomes `BvhMotion.calibration`. Files reduced to some joints (BEAT's as prepared for its
    baselines) keep the other joints' pose in row 0, and one constant value from row 1 on. Both
    would make the body jump once, so leftover values are replaced by those of row 1.
    """
    return _without_leftover_joints(_without_calibration(motion))


def _without_calibration(motion: BvhMotion) -> BvhMotion:
    """Remove a first row that differs from all others."""
    if len(motion.values) < 3 or np.abs(motion.values[0] - motion.values[1]).max() <= _STILL:
        return motion
    # The first change alone nearly always decides, and a recording has thousands.
    if _changes(replace(motion, values=motion.values[:2]))[0] < _JUMP:
        return motion
    changes = _changes(motion)
    if changes[0] < max(_JUMP, _JUMP_RATIO * np.quantile(changes[1:], _NEARLY_ALL)):
        return motion
    values = motion.values.copy()
    values[0] = values[1]
    note = "the first frame is not part of the motion; the second is shown in its place"
    return replace(motion, values=values, calibration=motion.values[0], notes=(*motion.notes, note))


def _changes(motion: BvhMotion) -> Floats:
    """Return the turn from each row to the next, in degrees summed over all joints, (T - 1,)."""
    turns = motion.local_rotations()
    steps = np.swapaxes(turns[:-1], 2, 3) @ turns[1:]
    angles = Rotation.from_matrix(steps.reshape(-1, 3, 3)).magnitude()
    return np.asarray(np.degrees(angles.reshape(len(steps), -1)).sum(axis=1))


def _without_leftover_joints(motion: BvhMotion) -> BvhMotion:
    """Give joints that never move after row 0 their later values in row 0."""
    values = motion.values.copy()
    settled = 0
    for index in range(len(motion.joints)):
        columns = values[:, motion.columns(index)]
        if len(columns) < 3 or not columns.shape[1]:
            continue
        still_later = np.ptp(columns[1:], axis=0).max() <= _STILL
        if still_later and np.abs(columns[0] - columns[1]).max() > _STILL:
            columns[0] = columns[1]
            settled += 1
    if not settled:
        return motion
    note = (
        f"{settled} joints that never move after the first frame had another pose in it; "
        "they take their later values there"
    )
    return replace(motion, values=values, notes=(*motion.notes, note))


def write_bvh(path: Path, motion: BvhMotion) -> None:
    """Write `motion` to `path`, in one step.

    Joints are written depth first, whatever their order in `motion`, and their columns with them.
    Numbers have four decimals. A joint without children gets an end site at its own position, since
    many readers expect one.

    Parameters
    ----------
    path : Path
        The file; missing folders are made.
    motion : BvhMotion
        The motion; at least one frame, finite values.
    """
    order = list(_depth_first(motion.joints, 0))
    columns = np.concatenate([np.r_[motion.columns(index)] for index in order]).astype(int)
    lines = ["HIERARCHY", *_hierarchy_lines(motion.joints, 0, 0)]
    lines += ["MOTION", f"Frames: {len(motion.values)}"]
    lines.append(f"Frame Time: {1 / motion.frame_rate:.8f}")
    # Adding zero turns -0 into 0, so that a constant column is always written the same.
    rounded = np.round(motion.values[:, columns], _DECIMALS) + 0.0
    lines += [" ".join(_number(value) for value in row) for row in rounded.tolist()]
    write_text(Path(path), "\n".join(lines) + "\n")


def write_clip_bvh(path: Path, clip: MotionClip, rest_joints: NDArray[np.floating]) -> None:
    """Write the joints of `clip` to `path`, in one step.

    Joints have SMPL-X's names; lengths are centimetres, as in recordings.

    Parameters
    ----------
    path : Path
        The file; missing folders are made.
    clip : MotionClip
        The motion.
    rest_joints : ndarray, shape (55, 3)
        Joints of the unposed body in metres, as `motion.body.model.BodyModel.joints` returns them.
    """
    offsets = np.array(rest_joints, float) * _CENTIMETRES
    root = offsets[0] + clip.trans * _CENTIMETRES
    offsets[1:] -= offsets[list(PARENTS[1:])]
    offsets[0] = 0  # programs disagree on whether the root's positions are added to its offset
    joints = tuple(
        BvhJoint(
            name=name,
            parent=parent,
            offset=(float(offset[0]), float(offset[1]), float(offset[2])),
            channels=_ROOT if parent < 0 else _TURNS,
        )
        for name, parent, offset in zip(JOINT_NAMES, PARENTS, offsets, strict=True)
    )
    turns = Rotation.from_rotvec(clip.poses.reshape(-1, 3).astype(float))
    angles = turns.as_euler(_ORDER, degrees=True, suppress_warnings=True)
    # Programs that interpolate between frames must not see a jump from 180 to -180 degrees.
    angles = np.unwrap(angles.reshape(len(clip), JOINT_COUNT * 3), axis=0, period=360)
    values = np.concatenate([root, angles], axis=1)
    write_bvh(path, BvhMotion(joints=joints, values=values, frame_rate=clip.frame_rate))


def _children(joints: Sequence[BvhJoint], parent: int) -> list[int]:
    return [index for index, joint in enumerate(joints) if joint.parent == parent]


def _depth_first(joints: Sequence[BvhJoint], index: int) -> Iterator[int]:
    yield index
    for child in _children(joints, index):
        yield from _depth_first(joints, child)


def _hierarchy_lines(joints: Sequence[BvhJoint], index: int, depth: int) -> Iterator[str]:
    """Yield the lines of a joint and its descendants."""
    joint, outer_indent, inner_indent = joints[index], "\t" * depth, "\t" * (depth + 1)
    yield f"{outer_indent}{'ROOT' if depth == 0 else 'JOINT'} {joint.name}"
    yield f"{outer_indent}{{"
    yield f"{inner_indent}OFFSET {_offset_line(joint.offset)}"
    yield f"{inner_indent}CHANNELS {len(joint.channels)} {' '.join(joint.channels)}".rstrip()
    children = _children(joints, index)
    for child in children:
        yield from _hierarchy_lines(joints, child, depth + 1)
    if not children:
        yield from (f"{inner_indent}End Site", f"{inner_indent}{{")
        yield from (f"{inner_indent}\tOFFSET {_offset_line((0.0, 0.0, 0.0))}", f"{inner_indent}}}")
    yield f"{outer_indent}}}"


def _offset_line(offset: tuple[float, float, float]) -> str:
    return " ".join(f"{value + 0.0:.6f}" for value in offset)


def _number(value: float) -> str:
    return f"{value:.{_DECIMALS}f}".rstrip("0").rstrip(".") if value else "0"
