"""Motion files: the study's own format and those of other tools."""

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from motion.arrays import Floats32
from motion.body.archive import add_mean_hands
from motion.clip import MotionClip
from motion.errors import InputError, found_at
from motion.formats.beat_tracks import face_beside, read_arkit_json
from motion.formats.bvh import read_bvh
from motion.formats.bvh_motion import settle_first_frame
from motion.formats.clip_npz import (
    has_fingers_relative_to_mean_hands,
    has_provenance,
    read_clip,
    write_clip,
)
from motion.formats.joint_maps import JointMap, check_joint_map, choose_joint_map
from motion.formats.joint_positions import holds_joints, read_joints
from motion.formats.retarget import retarget
from motion.formats.smplx_rows import read_rows
from motion.placement import clear_of_body, place
from motion.segment import CUT_TOLERANCE
from motion.skeleton import FINGERS, RELAXED_HANDS

__all__ = ["read_clip", "read_motion", "read_recorded", "write_clip"]

_UNMOVED: Final = 1e-6
"""Largest angle of fingers that a file does not hold, in radians."""


def read_motion(
    path: Path,
    *,
    frame_rate: float | None = None,
    joint_map: JointMap | None = None,
    mean_hands: Floats32 | None = None,
    as_recorded: bool = False,
) -> MotionClip:
    """Read a motion file of any known format, whatever its ending, into the study's world.

    Parameters
    ----------
    path : Path
        BVH of any skeleton, ``.npz`` (AMASS, BEAT2, AMUSE, SMPL, SMPL+H, own), ``.npy`` of
        TalkSHOW or Motion-X; joint positions as `motion.formats.joint_positions` reads them.
    frame_rate : float, optional
        Frames per second; overrides the file's own.
    joint_map : mapping of str to str, optional
        For a BVH or joint positions of an unknown skeleton: SMPL-X joint names to the file's.
    mean_hands : ndarray, shape (30, 3), optional
        SMPL-X's mean hands, as `motion.body.archive.read_mean_hands` returns them. Fingers of
        BEAT2, TalkSHOW and Motion-X are relative to them. Relaxed hands by default.
    as_recorded : bool
        Whether hands of a BVH or of joint positions may stay inside the body, instead of being
        moved out by `motion.placement.clear_of_body`.

    Returns
    -------
    MotionClip
        Standing on the floor at the origin, y up, facing +z; a file of `write_clip` is returned
        unchanged. The provenance has ``source`` (the file's name), ``format`` and any ``notes``.

    Raises
    ------
    InputError
        If the file is missing, unusable or of an unknown format; the message names it.
    """
    path = Path(path)
    try:
        with path.open("rb") as file:
            start = file.read(512)
    except OSError as error:
        raise InputError(
            "the motion file cannot be read", where=path, remedy="Check the path"
        ) from error
    if holds_joints(path, start):
        clip = read_joints(path, frame_rate=frame_rate, joint_map=joint_map)
        clip, notes = (clip, ()) if as_recorded else clear_of_body(clip)
        note = "rotations were computed from joint positions; bones have our body's lengths"
        return _placed(clip, path, "joint positions", (note, *notes))
    if start.startswith(b"PK"):
        clip = read_clip(path, frame_rate=frame_rate)
        if has_provenance(path):
            return clip
        if not has_fingers_relative_to_mean_hands(path):
            return _placed(clip, path, "npz")
        clip, note = _with_absolute_fingers(clip, mean_hands)
        return _placed(clip, path, "npz (BEAT2)", (note,))
    if start.startswith(b"\x93NUMPY"):
        clip = read_rows(path, frame_rate=frame_rate)
        clip, note = _with_absolute_fingers(clip, mean_hands)
        return _placed(clip, path, clip.provenance["format"], (note,))
    if start.removeprefix(b"\xef\xbb\xbf").lstrip().upper().startswith(b"HIERARCHY"):
        return _read_bvh_clip(path, frame_rate, joint_map, as_recorded)
    raise InputError(
        "the file is not motion of a known format",
        where=path,
        remedy="Give a .bvh, an SMPL-X .npz, a .npy file of TalkSHOW or Motion-X, or joint "
        "positions with their names",
    )


def read_recorded(path: Path, **options: Any) -> tuple[MotionClip, list[str]]:
    """Return a motion with the face of its companion file, and notes on both.

    BEAT, and generators that use its format, store a take's face in a JSON file of the same name.
    A clip with its own face keeps it. After the last frame of the file, the face stays still.

    Parameters
    ----------
    path : Path
        The motion.
    **options
        Keyword arguments of `read_motion`, which also lists the errors.
    """
    clip = read_motion(path, **options)
    note = clip.provenance.get("notes", "")
    notes = [f"{path.name}: {note}"] if note else []
    companion = face_beside(path)
    if clip.faces or not companion.is_file():
        return clip, notes
    try:
        face = read_arkit_json(companion, clip.frame_rate)
    except InputError as error:
        return clip, [*notes, f"{companion.name}, next to {path.name}, is left out: {error.what}"]
    frames = face[np.minimum(np.arange(len(clip)), len(face) - 1)]
    note = f"{path.name}: the face is from {companion.name}"
    missing = (len(clip) - len(face)) / clip.frame_rate
    if missing > CUT_TOLERANCE:
        note += f" and stays still for the last {missing:.1f} s, which that file lacks"
    return replace(clip, arkit=frames), [*notes, note]


def _read_bvh_clip(
    path: Path, frame_rate: float | None, joint_map: JointMap | None, as_recorded: bool
) -> MotionClip:
    motion = settle_first_frame(read_bvh(path, frame_rate=frame_rate))
    with found_at(path):
        if joint_map is None:
            skeleton, fitting = choose_joint_map(motion.joint_names)
        else:
            skeleton, fitting = "own map", check_joint_map(joint_map, motion.joint_names)
        clip = retarget(motion, fitting)
    clip, notes = (clip, ()) if as_recorded else clear_of_body(clip)
    return _placed(clip, path, f"bvh ({skeleton})", (*motion.notes, *notes))


def _with_absolute_fingers(clip: MotionClip, mean_hands: Floats32 | None) -> tuple[MotionClip, str]:
    """Return a clip whose fingers do not depend on the mean hands, and a note about them."""
    if mean_hands is not None:
        note = "fingers were relative to SMPL-X's mean hands, taken from the licensed model"
        return add_mean_hands(clip, mean_hands), note
    note = (
        "fingers are relative to SMPL-X's mean hands, which only a licensed model has; relaxed "
        "hands took their place (name the model as video.body and import again)"
    )
    return add_mean_hands(clip, RELAXED_HANDS), note


def _with_relaxed_fingers(clip: MotionClip) -> tuple[MotionClip, tuple[str, ...]]:
    """Return a clip in which missing fingers are relaxed, not straight and spread, and a note."""
    largest_angles = np.abs(clip.poses[:, FINGERS]).max(axis=(0, 2)).reshape(-1, 3).max(axis=1)
    is_unset = largest_angles < _UNMOVED
    if not is_unset.any():
        return clip, ()
    poses = clip.poses.copy()
    joints = np.flatnonzero(np.repeat(is_unset, 3))
    poses[:, FINGERS.start + joints] = RELAXED_HANDS[joints]
    subject = "no finger is" if is_unset.all() else f"{is_unset.sum()} of 10 fingers are not"
    return replace(clip, poses=poses), (f"{subject} in the file; relaxed ones are shown",)


def _placed(
    clip: MotionClip, path: Path, format_name: str, notes: tuple[str, ...] = ()
) -> MotionClip:
    """Return the clip in the study's world, with its origin and `notes` in the provenance."""
    clip, fingers = _with_relaxed_fingers(clip)
    clip, turns = place(clip)
    clip = clip.with_provenance(source=path.name, format=format_name)
    note = "; ".join((*notes, *fingers, *turns))
    return clip.with_provenance(notes=note) if note else clip
