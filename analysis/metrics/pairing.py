"""A generated clip beside the recording of the same speech, frame by frame."""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

LEAST_OVERLAP: Final = 0.9
"""A clip shorter than this share of the other is not the same segment."""


def paired(generated: FloatArray, recorded: FloatArray) -> tuple[FloatArray, FloatArray, str]:
    """Return two clips cut to the shorter one, and why they do not pair, if they do not.

    Parameters
    ----------
    generated, recorded : ndarray, shape (T, ...), (U, ...)
        Of one frame rate and one representation.

    Returns
    -------
    generated, recorded : ndarray
        Cut to equally many frames.
    reason : str
        Empty where they pair.

    Raises
    ------
    ValueError
        If the shapes differ in more than the number of frames.
    """
    if generated.shape[1:] != recorded.shape[1:]:
        raise ValueError(f"frames of shapes {generated.shape[1:]} and {recorded.shape[1:]}")
    lengths = len(generated), len(recorded)
    frames = min(lengths)
    reason = ""
    if not frames:
        reason = "a clip has no frame"
    elif frames < LEAST_OVERLAP * max(lengths):
        reason = f"the clip has {lengths[0]} frames and the recording {lengths[1]}"
    return generated[:frames], recorded[:frames], reason
