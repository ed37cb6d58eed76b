"""The ``.npz`` file of a body, read without running anything in it, and its mean hands."""

import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.lib.npyio import NpzFile

from motion.arrays import Floats32
from motion.clip import MotionClip
from motion.errors import InputError
from motion.skeleton import FINGERS, RELAXED_HANDS

_MEAN_HANDS: Final = ("hands_meanl", "hands_meanr")


@contextmanager
def body_archive(path: Path) -> Iterator[NpzFile]:
    """Open a body model's archive; each array is read when it is accessed.

    Raises
    ------
    InputError
        If the file is missing or not an archive, or an array read in the block is damaged or would
        run code.
    """
    if not path.is_file():
        raise InputError(
            "there is no such body model", where=path, remedy="Give the path of an SMPL-X .npz file"
        )
    try:
        with path.open("rb") as file:
            content = np.load(file, allow_pickle=False)
            if not isinstance(content, NpzFile):
                raise ValueError("a single array")
            with content as archive:
                yield archive
    except (ValueError, OSError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise InputError(
            "the file cannot be read as a body model: it is not a NumPy archive, or damaged",
            where=path,
            remedy="Give an SMPL-X model in .npz format; convert a .pkl with the smplx tools",
        ) from error


def read_mean_hands(body: Path) -> Floats32 | None:
    """Return the mean hands of an SMPL-X model file, shape (30, 3); None where it has none.

    Raises
    ------
    InputError
        If the file is missing or cannot be read.
    """
    with body_archive(body) as archive:
        if any(name not in archive for name in _MEAN_HANDS):
            return None
        mean_hands = np.concatenate([archive[name].reshape(-1) for name in _MEAN_HANDS])
    if mean_hands.size != len(RELAXED_HANDS) * 3 or not mean_hands.any():
        return None
    return mean_hands.reshape(len(RELAXED_HANDS), 3).astype(np.float32)


def add_mean_hands(clip: MotionClip, mean_hands: Floats32) -> MotionClip:
    """Convert finger rotations relative to mean hands into absolute ones.

    Parameters
    ----------
    clip : MotionClip
        Zero finger rotations are the mean hands, as in a model created with
        ``flat_hand_mean=False``.
    mean_hands : ndarray, shape (30, 3)
        Axis-angle in radians; added to the clip's as SMPL-X adds them.
    """
    poses = clip.poses.copy()
    poses[:, FINGERS] += mean_hands
    return replace(clip, poses=poses)
