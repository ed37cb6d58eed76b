"""A part of a file that reads like a whole one."""

from __future__ import annotations

from pathlib import Path


class FilePart:
    """The bytes of `path` from `start` up to, not including, `stop`.

    A server that knows the number of bytes may also let the kernel send them, from where the
    descriptor stands.
    """

    def __init__(self, path: Path, start: int, stop: int) -> None:
        self._file = path.open("rb", buffering=0)
        self._file.seek(start)
        self._left = stop - start

    def read(self, size: int = -1) -> bytes:
        """Return the next bytes, at most `size` of them where it is not negative."""
        wanted = self._left if size < 0 else min(size, self._left)
        block = self._file.read(wanted) or b""
        self._left -= len(block)
        return block

    def fileno(self) -> int:
        """Return the file's descriptor."""
        return self._file.fileno()

    def close(self) -> None:
        """Close the file."""
        self._file.close()
