"""Refusing motion of a network whose training has diverged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError


def check_finite(motion: NDArray[np.float64], checkpoint: Path) -> None:
    """Check what a network told.

    Raises
    ------
    InputError
        If a value is not finite.
    """
    if not np.isfinite(motion).all():
        raise InputError(
            "the network tells motion that is not finite",
            where=checkpoint,
            remedy="Its training has diverged: give another checkpoint",
        )
