"""A take: one recording of speech and motion together, and the features computed from it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from motion.arrays import Floats32
from motion.errors import InputError

Split = Literal["train", "validation", "test"]
SPLITS: Final[tuple[Split, ...]] = ("train", "validation", "test")

Kind = Literal["beat", "beat2", "show", "ted"]
KINDS: Final[tuple[Kind, ...]] = ("beat", "beat2", "show", "ted")
"""Layouts of data sets that can be read."""

LONGEST_DIFFERENCE: Final = 0.5
"""Seconds by which the sound and motion of a take may differ in length."""


@dataclass(frozen=True, kw_only=True)
class Take:
    """One recording: speech and motion that begin at the same moment.

    Attributes
    ----------
    name : str
        Name of the take, unique in its folder; safe as a file name.
    speaker : str
        Name of the speaker in the folder.
    emotion : str
        One of `motion.segment.EMOTIONS`; empty if unknown.
    split : {'train', 'validation', 'test'}
        The split.
    speech, motion : Path
        Sound, and motion in the data set's own format.
    face : Path or None
        BEAT's facial weights (JSON); None if the motion includes the face or there is none.
    semantic : Path or None
        BEAT's annotated gestures.
    transcript : Path or None
        A transcript for `motion.formats.transcript`.
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

    @property
    def files(self) -> tuple[Path, ...]:
        """All files of the take."""
        paths = (self.speech, self.motion, self.face, self.semantic, self.transcript)
        return tuple(path for path in paths if path is not None)


@dataclass(frozen=True, kw_only=True)
class TakeFolder:
    """The takes of a folder of recordings.

    Attributes
    ----------
    kind : {'beat', 'beat2', 'show', 'ted'}
        Its layout.
    takes : tuple of Take
        Takes in order of their names.
    speakers : tuple of str
        All speakers, in the order of the data set.
    skipped : tuple of InputError
        Why other files could not be used.
    notes : tuple of str
        Remarks on the splits, and on names in a split list without a take.
    """

    kind: Kind
    takes: tuple[Take, ...]
    speakers: tuple[str, ...]
    skipped: tuple[InputError, ...] = ()
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Feature:
    """A feature computed from the files of a take.

    Attributes
    ----------
    name : str
        Lower-case letters, digits and '_', such as ``gesture`` or ``mel``.
    version : str
        Changes whenever the result of `compute` may change: with its code, its settings and the
        weights of a network that it uses.
    compute : callable
        Maps a take to (frames, channels) float32, at least one frame. Frame k is at
        ``k / frame_rate`` seconds from the start of the take. It depends on the take's files only,
        and raises `InputError` if one is unusable.
    """

    name: str
    version: str
    compute: Callable[[Take], Floats32]
