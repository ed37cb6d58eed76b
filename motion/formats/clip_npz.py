"""Motion clips as ``.npz``: the study's own files, and the variants of other projects.

Only the arrays of a clip are read, since AMASS and MoSh++ add Python objects. The study's own files
hold ``poses`` (T, 165), ``trans``, ``betas``, ``gender``, ``mocap_frame_rate``, ``provenance`` (a
JSON object), and ``expressions`` and ``arkit`` if the clip has them.
"""

import json
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter, ValidationError

from motion.clip import EXPRESSION_COUNT, MotionClip, check_frame_rate
from motion.errors import InputError, found_at
from motion.files import replacing
from motion.formats.archives import load_arrays
from motion.formats.smplx_rows import MOTION_X_WIDTH, motion_x_clip
from motion.skeleton import BODY_JOINTS, FACE_JOINTS, JOINT_COUNT

Arrays = Mapping[str, NDArray[Any]]

_RATE_KEYS: Final = ("mocap_frame_rate", "mocap_framerate", "fps")
_TRANS_KEYS: Final = ("trans", "transl")
_EXPRESSION_KEYS: Final = ("expressions", "expression")
_POSE_PARTS: Final = (
    ("root_orient", 1), ("pose_body", 21), ("pose_jaw", 1), ("pose_eye", 2), ("pose_hand", 30),
)  # fmt: skip
"""AMASS's arrays that make up the poses, in SMPL-X's order, and their joint counts."""
_KNOWN_KEYS: Final = frozenset(
    {
        *("poses", "betas", "arkit", "gender", "provenance"),
        *(*_RATE_KEYS, *_TRANS_KEYS, *_EXPRESSION_KEYS),
        *(name for name, _ in _POSE_PARTS),
    }
)
_PROVENANCE: Final = TypeAdapter(dict[str, str])
_BEAT2_MODEL: Final = "smplx2020"
_SMPLH_JOINT_COUNT: Final = 52
"""SMPL+H has SMPL-X's joints except the three of the face."""
_SMPL_JOINT_COUNT: Final = 24
"""SMPL has SMPL-X's body joints, then a joint for each whole hand, which is ignored."""


def write_clip(path: Path, clip: MotionClip) -> None:
    """Write `clip` to `path` in one step; equal clips give equal bytes."""
    arrays: dict[str, NDArray[Any]] = {
        "poses": clip.poses.reshape(len(clip), -1),
        "trans": clip.trans,
        "betas": clip.betas,
        "gender": np.array(clip.gender),
        "mocap_frame_rate": np.array(clip.frame_rate),
        "provenance": np.array(json.dumps(dict(clip.provenance), sort_keys=True)),
        **clip.faces,
    }
    with replacing(path) as draft, draft.open("wb") as file:
        np.savez_compressed(file, allow_pickle=False, **arrays)


def read_clip(path: Path, *, frame_rate: float | None = None) -> MotionClip:
    """Read a motion clip from an ``.npz`` file, unchanged.

    Parameters
    ----------
    path : Path
        A file of `write_clip`, or of AMASS, MoSh++, BEAT2, AMUSE (SMPL-X, poses (T, 165) or (T, 55,
        3), or in parts such as ``root_orient``), SMPL+H ((T, 156) or (T, 52, 3)), SMPL ((T, 72) or
        (T, 24, 3)) or Motion-X ((T, 322)). Joints that it lacks stay at rest.
    frame_rate : float, optional
        Frames per second; overrides the file's own.

    Returns
    -------
    MotionClip
        Its provenance is the file's, or empty.

    Raises
    ------
    InputError
        If the file is missing, is not an ``.npz``, needs unpickling, lacks poses or a frame rate,
        or its arrays are not a clip. Pickled content is never loaded.
    """
    path = Path(path)
    with found_at(path):
        arrays = load_arrays(path, _KNOWN_KEYS)
        rows = arrays.get("poses", np.zeros(0))
        if rows.ndim == 2 and rows.shape[1] == MOTION_X_WIDTH:
            rate = _frame_rate(arrays) if frame_rate is None else frame_rate
            return motion_x_clip(_numbers(rows, "poses"), rate)
        poses = _poses(arrays)
        return MotionClip(
            poses=poses,
            trans=_numbers(_first(arrays, _TRANS_KEYS, np.zeros((len(poses), 3))), "trans"),
            frame_rate=_frame_rate(arrays) if frame_rate is None else frame_rate,
            betas=_betas(arrays),
            expressions=_expressions(arrays),
            arkit=_numbers(arrays["arkit"], "arkit") if "arkit" in arrays else None,
            gender=_gender(arrays),
            provenance=_provenance(arrays),
        )


def read_frame_rate(path: Path) -> float:
    """Return the frame rate that the ``.npz`` file at `path` states, without reading its motion.

    Raises
    ------
    InputError
        As in `read_clip`; and if the file states no usable frame rate.
    """
    path = Path(path)
    with found_at(path):
        frame_rate = _frame_rate(load_arrays(path, _RATE_KEYS))
        check_frame_rate(frame_rate)
    return frame_rate


def has_provenance(path: Path) -> bool:
    """Return whether the ``.npz`` file at `path` was written by `write_clip`."""
    with zipfile.ZipFile(path) as archive:
        return "provenance.npy" in archive.namelist()


def has_fingers_relative_to_mean_hands(path: Path) -> bool:
    """Return whether the ``.npz`` file at `path` is BEAT2's or of a model trained on it.

    Zero finger rotations are SMPL-X's mean hands there (Liu et al. 2024, EMAGE: models are created
    with ``flat_hand_mean=False``), and flat hands in AMASS.
    """
    return str(load_arrays(path, ("model",)).get("model")) == _BEAT2_MODEL


def _first(arrays: Arrays, keys: tuple[str, ...], default: NDArray[Any]) -> NDArray[Any]:
    return next((arrays[key] for key in keys if key in arrays), default)


def _poses(arrays: Arrays) -> NDArray[Any]:
    """Return the poses of any known layout as (T, 55, 3)."""
    if "poses" not in arrays:
        return _poses_of_parts(arrays)
    poses = _numbers(arrays["poses"], "poses")
    values = poses.shape[1] if poses.ndim == 2 else 0
    if poses.ndim == 2 and values % 3 == 0:
        poses = poses.reshape(len(poses), values // 3, 3)
    layouts = {JOINT_COUNT, _SMPLH_JOINT_COUNT, _SMPL_JOINT_COUNT}
    if poses.ndim != 3 or poses.shape[1] not in layouts or poses.shape[2] != 3:
        raise InputError(
            f"poses has shape {arrays['poses'].shape}",
            remedy="Give (T, 165) or (T, 55, 3) for SMPL-X, (T, 156) or (T, 52, 3) for SMPL+H, "
            "(T, 72) or (T, 24, 3) for SMPL, or (T, 322) for Motion-X",
        )
    if poses.shape[1] == JOINT_COUNT:
        return poses
    face, fingers = len(FACE_JOINTS), JOINT_COUNT - len(BODY_JOINTS) - len(FACE_JOINTS)
    body, hands = np.split(poses, [len(BODY_JOINTS)], axis=1)
    if poses.shape[1] == _SMPL_JOINT_COUNT:
        hands = np.zeros((len(poses), fingers, 3), np.float32)
    return np.concatenate([body, np.zeros((len(poses), face, 3), np.float32), hands], axis=1)


def _poses_of_parts(arrays: Arrays) -> NDArray[Any]:
    """Return poses (T, 55, 3) from their parts; a missing part is at rest."""
    if "root_orient" not in arrays or "pose_body" not in arrays:
        raise InputError(
            f"the file has no 'poses', only {', '.join(sorted(arrays)) or 'unknown arrays'}",
            remedy="Give SMPL-X axis-angle poses of shape (T, 165) under the key 'poses', or "
            "'root_orient', 'pose_body' and 'pose_hand'",
        )
    frames = len(arrays["root_orient"]) if arrays["root_orient"].ndim else 0
    parts = []
    for name, joints in _POSE_PARTS:
        part = _numbers(arrays.get(name, np.zeros((frames, 3 * joints), np.float32)), name)
        if part.size != frames * 3 * joints or len(part) != frames:
            raise InputError(
                f"{name} has shape {part.shape}", remedy=f"Give ({frames}, {3 * joints})"
            )
        parts.append(part.reshape(frames, joints, 3))
    return np.concatenate(parts, axis=1)


def _numbers(array: NDArray[Any], key: str) -> NDArray[Any]:
    if array.dtype.kind not in "fiu":
        raise InputError(f"{key!r} holds no numbers", remedy=f"Give {key} as floating point")
    return array


def _frame_rate(arrays: Arrays) -> float:
    for key in _RATE_KEYS:
        if key in arrays and arrays[key].size == 1:
            rate = arrays[key]
            _numbers(rate, key)
            return float(rate.item())
    raise InputError(
        f"the file gives no frame rate (looked for {', '.join(_RATE_KEYS)})",
        remedy="State the frame rate (--fps)",
    )


def _betas(arrays: Arrays) -> NDArray[Any]:
    """Return one set of betas, which a file may repeat in every frame."""
    betas = _numbers(arrays.get("betas", np.zeros(0, np.float32)), "betas")
    if betas.ndim == 2 and len(betas):
        if np.abs(betas - betas[0]).max(initial=0) > 1e-6:
            raise InputError(
                "betas change over time", remedy="Give one set of betas for the whole motion"
            )
        return np.array(betas[0])
    return betas


def _expressions(arrays: Arrays) -> NDArray[Any] | None:
    """Return the expressions, with zeros for the coefficients that the file lacks."""
    expressions = _first(arrays, _EXPRESSION_KEYS, np.zeros(0, np.float32))
    if not expressions.size:
        return None
    expressions = _numbers(expressions, "expressions")
    if expressions.ndim == 2 and expressions.shape[1] < EXPRESSION_COUNT:
        return np.pad(expressions, ((0, 0), (0, EXPRESSION_COUNT - expressions.shape[1])))
    return expressions


def _gender(arrays: Arrays) -> str:
    gender = arrays.get("gender", np.array("neutral"))
    value = gender.item() if gender.size == 1 else gender
    return value.decode("ascii", "replace") if isinstance(value, bytes) else str(value)


def _provenance(arrays: Arrays) -> dict[str, str]:
    if "provenance" not in arrays:
        return {}
    try:
        return _PROVENANCE.validate_json(str(arrays["provenance"]))
    except ValidationError as error:
        raise InputError(
            "provenance is not a JSON object of texts", remedy="Remove the key or generate again"
        ) from error
