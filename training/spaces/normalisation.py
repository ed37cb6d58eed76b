"""Between a network's values, of mean 0 and variance 1, and the motion's own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from generators.diffsheg.config import DenoiserConfig
from motion.errors import InputError

FloatArray = NDArray[np.float64]

_CONSTANT: Final = 1e-6
"""Standard deviations below this are rounding: such a value never changes."""

_REMEDY: Final = (
    "Name the folder that holds axis_angle_mean.npy, axis_angle_std.npy, json_mean.npy and "
    "json_std.npy, as released beside the checkpoint"
)


@dataclass(frozen=True, eq=False)
class Normalisation:
    """Mean and standard deviation of each value of a frame, the body's first.

    Attributes
    ----------
    mean, std : ndarray, shape (values,)
        Where `std` is zero, the value is constant.
    """

    mean: FloatArray
    std: FloatArray

    def normalised(self, motion: FloatArray) -> FloatArray:
        """Return `motion` (T, values) as a network sees it; constant values are 0."""
        varies = self._varies
        return np.asarray((motion - self.mean) * varies / np.where(varies, self.std, 1.0))

    def restored(self, normalised: FloatArray) -> FloatArray:
        """Return motion (T, values) in its own units; constant values are their mean."""
        return np.asarray(self.mean + np.where(self._varies, self.std, 0.0) * normalised)

    @property
    def _varies(self) -> NDArray[np.bool_]:
        return np.asarray(self.std >= _CONSTANT)


def read_normalisation(folder: Path, config: DenoiserConfig) -> Normalisation:
    """Read mean and standard deviation as DiffSHEG's release holds them.

    Parameters
    ----------
    folder : Path
        ``axis_angle_mean.npy`` and ``axis_angle_std.npy`` of the body, ``json_mean.npy`` and
        ``json_std.npy`` of the face, beside them or in ``facial52/``.
    config : DenoiserConfig
        How many values each has.

    Raises
    ------
    InputError
        If a file is missing, cannot be read, or is of another size.
    """
    parts = (("axis_angle", config.gesture_width), ("json", config.expression_width))
    mean, std = (
        np.concatenate([_read(folder, f"{part}_{kind}.npy", width) for part, width in parts])
        for kind in ("mean", "std")
    )
    if (std < 0).any():
        raise InputError("a standard deviation is negative", where=folder, remedy=_REMEDY)
    return Normalisation(mean, std)


def _read(folder: Path, name: str, width: int) -> FloatArray:
    path = next(
        (path for path in (folder / name, folder / "facial52" / name) if path.is_file()),
        folder / name,
    )
    try:
        values = np.load(path, allow_pickle=False)
    except FileNotFoundError as error:
        raise InputError("there is no such file", where=path, remedy=_REMEDY) from error
    except (OSError, EOFError, ValueError) as error:
        raise InputError(
            "the file cannot be read as a plain array", where=path, remedy=_REMEDY
        ) from error
    if values.shape != (width,) or values.dtype.kind not in "fiu" or not np.isfinite(values).all():
        raise InputError(
            f"the array has shape {values.shape} and type {values.dtype}, and {width} finite "
            "numbers are needed",
            where=path,
            remedy=_REMEDY,
        )
    return np.asarray(values, dtype=np.float64)
