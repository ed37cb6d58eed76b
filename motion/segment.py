"""A speech segment: one excerpt of speech that every condition of a study moves to."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from motion.errors import InputError

EMOTIONS: Final = (
    "neutral",
    "happiness",
    "anger",
    "sadness",
    "contempt",
    "surprise",
    "fear",
    "disgust",
)
"""The eight emotion labels of BEAT (Liu et al. 2022), which AMUSE's study uses too."""

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}")


def check_name(name: str, kind: str, where: object = "") -> str:
    """Return `name` if it is safe as a file name in a study folder, else raise `InputError`."""
    if not _NAME.fullmatch(name):
        raise InputError(
            f"{name!r} is not a usable {kind} name",
            where=where,
            remedy="Use letters, digits, '_', '-' and '.', starting with a letter or digit",
        )
    return name


@dataclass(frozen=True, kw_only=True)
class Segment:
    """One speech excerpt.

    Attributes
    ----------
    name : str
        Identifies the segment within its study; also the stem of its files.
    wav : str
        File name of the speech, relative to the study's ``speech`` folder.
    start, end : float
        Where the excerpt lies in `wav`, in seconds, ``0 <= start < end``.
    speaker : str
        Who speaks.
    emotion : str
        One of `EMOTIONS`.
    transcript : str
        What is said; empty where unknown.
    """

    name: str
    wav: str
    start: float
    end: float
    speaker: str
    emotion: str
    transcript: str = ""

    def __post_init__(self) -> None:
        check_name(self.name, "segment")
        if Path(self.wav).name != self.wav:
            raise InputError(
                f"segment {self.name}: wav {self.wav!r} must be a plain file name",
                remedy="Put the file into the study's speech folder and give its name alone",
            )
        if not 0 <= self.start < self.end < math.inf:
            raise InputError(
                f"segment {self.name}: start {self.start} and end {self.end} make no excerpt",
                remedy="Give 0 <= start < end in seconds",
            )
        if self.emotion not in EMOTIONS:
            raise InputError(
                f"segment {self.name}: unknown emotion {self.emotion!r}",
                remedy=f"Use one of {', '.join(EMOTIONS)}",
            )

    @property
    def duration(self) -> float:
        """Length of the excerpt in seconds."""
        return self.end - self.start


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
