"""A take: one recording of speech and motion together."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

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
