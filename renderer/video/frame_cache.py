"""The lossless frames kept between rendering clips and composing pairs, up to a size."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path


class FrameCache:
    """A folder of frames that forgets what was used longest ago.

    Parameters
    ----------
    folder : Path
        Where the frames are; it need not exist.
    limit : int
        Bytes that may stay. What is needed stays in any case.
    """

    def __init__(self, folder: Path, limit: int) -> None:
        self._folder = folder
        self._limit = limit

    def size(self) -> int:
        """Return the bytes of all frames."""
        return sum(path.stat().st_size for path in self._files())

    def used(self, frames: Path) -> None:
        """Count `frames` as used just now; frames that are gone are let be."""
        if frames.exists():
            frames.touch()

    def keep_only(self, current: Collection[Path]) -> None:
        """Remove frames that no clip of the study has any more."""
        for path in self._files():
            if path not in current:
                path.unlink()

    def shrink(self, needed: Collection[Path]) -> None:
        """Remove frames until the limit is kept, those used longest ago first.

        Parameters
        ----------
        needed : collection of Path
            Frames that pairs are still to be composed from; they stay.
        """
        files = [(path.stat(), path) for path in self._files()]
        excess = sum(stat.st_size for stat, _ in files) - self._limit
        for stat, path in sorted(files, key=lambda file: (file[0].st_mtime_ns, file[1])):
            if excess <= 0:
                return
            if path not in needed:
                path.unlink()
                excess -= stat.st_size

    def _files(self) -> list[Path]:
        """Return all finished frames; drafts have names that begin with a dot."""
        return [path for path in self._folder.glob("*.mkv") if not path.name.startswith(".")]
