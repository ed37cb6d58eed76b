"""Files: atomic writing, content hashes, and cells that are safe in a spreadsheet."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import pandas as pd

_FORMULA_STARTS: Final = ("=", "+", "-", "@", "\t", "\r", "\n", "'")
"""First characters of spreadsheet formulas, and the apostrophe, so that `cell_as_given` can undo
`harmless_cell`."""

_NUMBER: Final = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")

APOSTROPHE: Final = "'"


@contextmanager
def replacing(path: Path, *, private: bool = False) -> Iterator[Path]:
    """Yield a temporary path in the same folder that replaces `path` when the block succeeds.

    An interruption leaves the old file or the new one, never half of one.

    Parameters
    ----------
    path : Path
        The file to be written; missing folders are made.
    private : bool
        Whether only its owner may read it; otherwise it has the permissions of any new file.

    Yields
    ------
    Path
        The path to write to, with the ending of `path`; removed if the block fails.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=".", suffix=path.suffix)
        os.close(handle)
        temporary = Path(name)
        try:
            yield temporary
            if not private:
                umask = os.umask(0)
                os.umask(umask)
                temporary.chmod(0o666 & ~umask)
            temporary.replace(path)
        finally:
            temporary.unlink(missing_ok=True)
    except OSError as error:
        # The error of a full disk names no file; other errors name the temporary one.
        is_named = error.filename and not Path(error.filename).name.startswith(".")
        if is_named or error.errno is None:
            raise
        raise OSError(error.errno, os.strerror(error.errno), str(path)) from error


def write_text(path: Path, text: str, *, private: bool = False) -> None:
    """Write UTF-8 `text` to `path` in one step, as `replacing` does."""
    with replacing(path, private=private) as temporary:
        temporary.write_text(text, encoding="utf-8")


def sha256_of(path: Path) -> str:
    """Return the SHA-256 of a file's content in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def harmless_cell(text: str) -> str:
    """Put an apostrophe before `text` if a spreadsheet might run it as a formula.

    Spreadsheets read the apostrophe as 'this is text' and do not show it. Plain numbers such as
    ``-2`` are not formulas and stay unchanged.
    """
    # Spaces before a formula do not keep every spreadsheet from running it.
    if not text.lstrip(" ").startswith(_FORMULA_STARTS) or _NUMBER.fullmatch(text):
        return text
    return APOSTROPHE + text


def cell_as_given(text: str) -> str:
    """Undo `harmless_cell`; all other text stays unchanged."""
    remainder = text[1:]
    return remainder if text[:1] == APOSTROPHE and harmless_cell(remainder) == text else text


def harmless_frame(frame: pd.DataFrame) -> pd.DataFrame:
    """Apply `harmless_cell` to all text of `frame`, headings included."""
    # Imported here: only callers with a frame need pandas, which is slow to import.
    import pandas as pd

    return pd.DataFrame(
        {
            _harmless(name): frame.iloc[:, place].map(_harmless, na_action="ignore")
            if _holds_text(frame.iloc[:, place])
            else frame.iloc[:, place]
            for place, name in enumerate(frame.columns)
        },
        index=frame.index,
    )


def write_frame(path: Path, frame: pd.DataFrame) -> None:
    """Write a table as CSV in one step, after `harmless_frame`."""
    with replacing(path) as draft:
        harmless_frame(frame).to_csv(draft, index=False, lineterminator="\n")


def _harmless(value: object) -> object:
    return harmless_cell(value) if isinstance(value, str) else value


def _holds_text(column: pd.Series[Any]) -> bool:
    from pandas.api.types import is_object_dtype, is_string_dtype

    return bool(is_object_dtype(column.dtype) or is_string_dtype(column.dtype))


def digest(*parts: object) -> str:
    """Return a short digest of `parts`: the contents of paths, the text form of other values."""
    state = hashlib.sha256()
    for part in parts:
        content = part.read_bytes() if isinstance(part, Path) else repr(part).encode()
        state.update(len(content).to_bytes(8, "little"))
        state.update(content)
    return state.hexdigest()[:32]
