"""Reading motion files as all metrics see them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from motion.clip import MotionClip
from motion.formats import read_clip, read_motion
from motion.freeze import freeze


@dataclass(frozen=True, kw_only=True)
class SeenMotion:
    """How motion files are read; the same for all of a run.

    Attributes
    ----------
    frozen : tuple of str
        Channels that the study holds still.
    own_files : bool
        Whether files are a study's own and read as they stand; files from elsewhere are of any
        format and put into the study's world.
    file_rate : float or None
        Frames per second of all files, in place of their own.
    """

    frozen: tuple[str, ...] = ()
    own_files: bool = True
    file_rate: float | None = None

    def read(self, path: Path) -> MotionClip:
        """Return the clip in `path`, with what is held still held still.

        Raises
        ------
        InputError
            If the file cannot be used.
        """
        read = read_clip if self.own_files else read_motion
        return freeze(read(path, frame_rate=self.file_rate), self.frozen)

    def __str__(self) -> str:
        """Return a text that differs where clips may be read otherwise."""
        return f"{sorted(self.frozen)} {self.own_files} {self.file_rate!r}"
