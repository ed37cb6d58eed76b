"""Files of joint positions: arrays with names, or in the order of a known skeleton."""

import re
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from motion.arrays import Floats
from motion.clip import MotionClip, check_frame_rate
from motion.errors import InputError, found_at
from motion.formats.archives import load_array, load_arrays
from motion.formats.joint_maps import JointMap
from motion.formats.ted_npz import ARRAYS as TED_ARRAYS
from motion.formats.ted_npz import AXES, JOINTS, chain_bones, read_ted_npz
from motion.points.joint_rotations import clip_from_joints
from motion.points.person import MEDIAPIPE, body_joints
from motion.skeleton import (
    BODY_JOINTS,
    JOINT_NAMES,
    LEFT_HAND_JOINTS,
    REST_JOINTS,
    RIGHT_HAND_JOINTS,
)

_TED: Final = (
    "pelvis", "neck", "nose", "crown", "left_shoulder", "left_elbow", "left_wrist",
    "right_shoulder", "right_elbow", "right_wrist",
)  # fmt: skip
_TED_LENGTHS: Final = (0.26, 0.18, 0.14, 0.22, 0.36, 0.33, 0.22, 0.36, 0.33)
"""Lengths of TED Gesture's bones, in its units (Yoon et al. 2020)."""

_SMPL: Final = (*BODY_JOINTS, "left_hand", "right_hand")
_KNOWN_ORDERS: Final[Mapping[int, tuple[str, ...]]] = {
    JOINTS: _TED,
    len(BODY_JOINTS): BODY_JOINTS,
    len(_SMPL): _SMPL,
    len(MEDIAPIPE): MEDIAPIPE,
    len(BODY_JOINTS) + 30: (*BODY_JOINTS, *LEFT_HAND_JOINTS, *RIGHT_HAND_JOINTS),
    len(JOINT_NAMES): JOINT_NAMES,
}
"""Skeletons by their number of joints: TED Gesture, SMPL without and with its hand joints,
MediaPipe, SMPL+H, SMPL-X."""

_OTHER_NAMES: Final = {
    "hips": "pelvis", "mid_hip": "pelvis", "midhip": "pelvis", "root": "pelvis",
    "left_foot_index": "left_foot", "right_foot_index": "right_foot",
    "left_toe": "left_foot", "right_toe": "right_foot", "head_top": "crown", "top_head": "crown",
}  # fmt: skip
_RATES: Final = ("frame_rate", "fps", "mocap_frame_rate", "mocap_framerate")


_Recording = tuple[Floats, tuple[str, ...], float | None]
"""Points (T, J, 3), the joints' names, and frames per second, or None if unknown."""


def holds_joints(path: Path, start: bytes) -> bool:
    """Return whether a file that begins with `start` holds joint positions."""
    if start.startswith(b"PK"):
        try:
            with zipfile.ZipFile(path) as archive:
                keys = {name.removesuffix(".npy") for name in archive.namelist()}
        except zipfile.BadZipFile:
            return False
        return "poses" not in keys and not keys.isdisjoint(TED_ARRAYS)
    is_array = start.startswith(b"\x93NUMPY")
    return is_array and bool(re.search(rb"'shape': \(\d+, \d+, [23]\)", start))


def read_joints(
    path: Path, *, frame_rate: float | None = None, joint_map: JointMap | None = None
) -> MotionClip:
    """Read joint positions as a motion; bones keep their directions and get our body's lengths.

    Parameters
    ----------
    path : Path
        ``.npz`` with `joints` (T, J, 3) and `names` (J), or a clip of TED Gesture; ``.npy`` of
        (T, J, 3) in the order of SMPL, SMPL+H, SMPL-X, MediaPipe or TED Gesture.
    frame_rate : float, optional
        Frames per second; overrides the file's own.
    joint_map : mapping of str to str, optional
        SMPL-X names of joints to those of the file.

    Raises
    ------
    InputError
        If the file cannot be read, or lacks the trunk or a frame rate.
    """
    with found_at(path):
        points, names, rate = _read(path)
        rate = rate if frame_rate is None else frame_rate
        if rate is None:
            raise InputError("the file gives no frame rate", remedy="State the frame rate (--fps)")
        check_frame_rate(rate)
        joints = body_joints(_named_points(points, names, joint_map), rate)
        return clip_from_joints(joints, REST_JOINTS, rate)


def _named_points(
    points: Floats, names: tuple[str, ...], joint_map: JointMap | None
) -> dict[str, Floats]:
    """Return the positions of joints, by SMPL-X name if the joint has one."""
    finite = np.isfinite(points).all(axis=2)
    if not finite.all():
        frame, joint = map(int, np.argwhere(~finite)[0])
        raise InputError(
            f"{names[joint]} is not a number in frame {frame}",
            remedy="Fill the gap or cut the frame",
        )
    if joint_map is not None:
        unknown = [name for name in joint_map.values() if name not in names]
        if unknown:
            raise InputError(
                f"the file has no joint {unknown[0]!r}; it has {', '.join(names)}",
                remedy="Correct the joint map",
            )
        places = {own_name: names.index(name) for own_name, name in joint_map.items()}
    else:
        places = {_normalised_name(name): place for place, name in enumerate(names)}
    return {name: points[:, place] for name, place in places.items()}


def _normalised_name(name: str) -> str:
    """Return a joint's name as SMPL-X writes it: LeftElbow and "left elbow" are left_elbow."""
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name.strip())
    normalised = re.sub(r"[\s.:-]+", "_", words).lower()
    return _OTHER_NAMES.get(normalised, normalised)


def _read(path: Path) -> _Recording:
    if not zipfile.is_zipfile(path):
        return *_in_known_order(load_array(path)), None
    arrays = load_arrays(path, (*TED_ARRAYS, "names", *_RATES))
    joints, names = arrays.get("joints"), arrays.get("names")
    if joints is None or (names is None and joints[:1].size == 3 * JOINTS):
        motion = read_ted_npz(path)
        points = chain_bones(np.array(_TED_LENGTHS)[:, None] * motion.directions)
        return points * AXES, _TED, motion.frame_rate
    rate = next((float(arrays[key]) for key in _RATES if key in arrays), None)
    if names is None:
        return *_in_known_order(joints), rate
    all_names = tuple(str(name) for name in names.reshape(-1))
    return _points(joints, all_names), all_names, rate


def _in_known_order(joints: NDArray[Any]) -> tuple[Floats, tuple[str, ...]]:
    names = _KNOWN_ORDERS.get(joints.shape[1] if joints.ndim == 3 else 0, ())
    points = _points(joints, names)
    return (points * AXES if names is _TED else points), names


def _points(joints: NDArray[Any], names: Sequence[str]) -> Floats:
    fits = joints.ndim == 3 and len(joints) and joints.shape[1:] == (len(names), 3)
    if not fits or joints.dtype.kind not in "fiu":
        raise InputError(
            f"the joints have shape {joints.shape} and type {joints.dtype}, with {len(names)} "
            "known names",
            remedy="Give 'joints' as numbers of shape (frames, J, 3), positions in space and not "
            "in a picture, with J 'names'; without names "
            f"J is one of {', '.join(map(str, sorted(_KNOWN_ORDERS)))}",
        )
    return joints.astype(np.float64)
