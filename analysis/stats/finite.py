"""Numbers that can be computed with."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError


def finite(values: NDArray[np.number]) -> NDArray[np.float64]:
    """Return `values` as floats.

    Raises
    ------
    InputError
        If one of them is missing or infinite.
    """
    numbers = np.asarray(values, np.float64)
    if not np.isfinite(numbers).all():
        raise InputError(
            f"value {int(np.argmin(np.isfinite(numbers.ravel()))) + 1} of {numbers.size} is "
            "missing or infinite",
            remedy="Leave answers out that are not there",
        )
    return numbers
