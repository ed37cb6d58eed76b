"""A take: one recording of speech and motion together, and what can be computed of it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from motion.errors import InputError
from motion.segment import EMOTIONS, check_name

Split = Literal["train", "validation", "test"]
SPLITS: Final[tuple[Split, ...]] = ("train", "validation", "test")

Kind = Literal["beat", "beat2", "show", "ted"]
KINDS: Final[tuple[Kind, ...]] = ("beat", "beat2", "show", "ted")
"""Layouts of data sets that are read."""

LONGEST_DIFFERENCE: Final = 0.5
"""Seconds by which sound and motion of a take may differ in length."""


@dataclass(frozen=True, kw_only=True)
class Take:
    """One recording: speech and motion that begin at the same moment.

    Attributes
    ----------
    name : str
        Identifies the take within its folder; safe as a file name.
    speaker : str
        Who speaks, as the folder names them.
    emotion : str
        One of `motion.segment.EMOTIONS`; empty where unknown.
    split : {'train', 'validation', 'test'}
        What it is for.
    speech, motion : Path
        Its sound, and its motion in the data set's own format.
    face : Path or None
        BEAT's facial weights (JSON), where the motion does not hold the face.
    semantic : Path or None
        BEAT's annotated gestures.
    transcript : Path or None
        What is said; see `motion.formats.transcript`.
    """

    name: str
    speaker: str
    emotion: str
    split: Split
    speech: Path
    motion: Path
    face: Path | None = None
    semantic: Path | None = None
    transcript: Path | None = None

    def __post_init__(self) -> None:
        check_name(self.name, "take")
        if self.emotion and self.emotion not in EMOTIONS:
            raise InputError(
                f"take {self.name}: unknown emotion {self.emotion!r}",
                remedy=f"Use one of {', '.join(EMOTIONS)}",
            )

    @property
    def files(self) -> tuple[Path, ...]:
        """All files of the take."""
        given = (self.speech, self.motion, self.face, self.semantic, self.transcript)
        return tuple(path for path in given if path is not None)


@dataclass(frozen=True, kw_only=True)
class TakeFolder:
    """What a folder of recordings holds.

    Attributes
    ----------
    kind : {'beat', 'beat2', 'show', 'ted'}
        Its layout.
    takes : tuple of Take
        In order of their names.
    speakers : tuple of str
        Everybody who speaks in a take, in order: numbers by size, names by letters.
    skipped : tuple of InputError
        What could not be used, and why.
    notes : tuple of str
        What a person should know: how the takes were split, names of a split list that are no take.
    """

    kind: Kind
    takes: tuple[Take, ...]
    speakers: tuple[str, ...]
    skipped: tuple[InputError, ...] = ()
    notes: tuple[str, ...] = ()


_NAME: Final = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True, kw_only=True)
class Feature:
    """Something computed from the files of a take.

    Attributes
    ----------
    name : str
        Lower-case letters, digits and '_', such as ``gesture`` or ``mel``.
    version : str
        Changes whenever what `compute` gives may change: with its code, its settings, and the
        weights of a network that it uses.
    compute : callable
        From a take to (frames, channels) float32, at least one frame. Frame k belongs to
        ``k / frame_rate`` seconds from the start of the take, at the frame rate at which the
        takes are prepared. Looks at the take's files alone. Raises `InputError` where a file is
        unusable.
    """

    name: str
    version: str
    compute: Callable[[Take], NDArray[np.float32]]

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name) or not self.version:
            raise ValueError(f"{self.name!r}, version {self.version!r}, is no feature")
