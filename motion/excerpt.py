"""Which samples or frames an excerpt in seconds means; speech and motion are cut by one rule."""

from __future__ import annotations

from typing import Final

from motion.errors import InputError

CUT_TOLERANCE: Final = 0.1
"""Seconds by which an excerpt may reach past the end of what it is cut from."""


def excerpt_bounds(start: float, end: float, *, rate: float, length: int) -> tuple[int, int]:
    """Return the first item of an excerpt and how many it has.

    Parameters
    ----------
    start, end : float
        Seconds, ``0 <= start < end``.
    rate : float
        Items (samples, frames) per second.
    length : int
        Items there are. An excerpt may ask for up to `CUT_TOLERANCE` seconds more.

    Returns
    -------
    first : int
        ``round(start * rate)``, below `length`.
    count : int
        ``round((end - start) * rate)``, at least 1.

    Raises
    ------
    InputError
        If the excerpt is empty or lies outside.
    """
    duration = length / rate
    if 0 <= start < end <= duration + CUT_TOLERANCE:
        first, count = round(start * rate), round((end - start) * rate)
        if first < length and count >= 1:
            return first, count
    raise InputError(
        f"an excerpt from {start:g} s to {end:g} s was asked of {duration:.2f} s",
        remedy="Give 0 <= start < end within the recording",
    )
