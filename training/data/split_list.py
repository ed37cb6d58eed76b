"""Lists that assign takes to training, validation and testing."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from pydantic import TypeAdapter, ValidationError

from motion.errors import InputError
from training.data.found_take import SPLIT_WORDS
from training.data.take import Split

USUAL_NAMES: Final = (
    "splits.csv",
    "split.csv",
    "train_test_split.csv",
    "train_val_test.json",
    "splits.json",
)
"""Names under which a folder's own list is found."""

_NAME_COLUMNS: Final = ("name", "id", "take", "clip", "file", "filename")
_SPLIT_COLUMNS: Final = ("split", "type", "set", "subset", "partition")
_ENDINGS: Final = (".bvh", ".npz", ".npy", ".wav", ".json", ".pkl", ".mp3", ".flac")
_FORMS: Final = (
    "Give a CSV with the columns name and split; JSON with lists of names under train, validation "
    "and test; or a folder of train.txt, validation.txt and test.txt"
)
_BY_SPLIT: Final = TypeAdapter(dict[str, list[str]])
_BY_NAME: Final = TypeAdapter(dict[str, str])


@dataclass(frozen=True, kw_only=True)
class SplitList:
    """The splits of takes.

    Attributes
    ----------
    path : Path
        File or folder of the list.
    splits : mapping of str to split
        Split of each name.
    others : mapping of str to str
        Names in a split of another kind, such as BEAT2's ``additional``.
    """

    path: Path
    splits: Mapping[str, Split]
    others: Mapping[str, str]


def read_split_list(path: Path) -> SplitList:
    """Read a split list.

    Parameters
    ----------
    path : Path
        CSV with a column of names (``name``, ``id``, …) and one of splits (``split``, ``type``, …),
        or two columns without a header; JSON of lists of names by split, or of splits by name; or a
        folder of ``train.txt``, ``val.txt`` and ``test.txt`` with one name per line. Names may have
        a file ending. Splits may be called train, val, dev, test, ….

    Raises
    ------
    InputError
        If it is none of these, names no split, or puts a name into two splits.
    """
    splits: dict[str, Split] = {}
    others: dict[str, str] = {}
    for name, word, where in _rows(path):
        name = without_ending(name)
        split = SPLIT_WORDS.get(word.lower())
        previous = splits.get(name) or others.get(name)
        if previous is not None and previous != (split or word):
            raise InputError(
                f"{name!r} is in {previous} and in {split or word}",
                where=where,
                remedy="Keep each take in one split",
            )
        if split:
            splits[name] = split
        else:
            others[name] = word
    if not splits:
        raise InputError("the split list names no split", where=path, remedy=_FORMS)
    return SplitList(path=path, splits=splits, others=others)


def without_ending(name: str) -> str:
    """Return the name of a take without a file ending, with ``/`` between folders."""
    name = name.strip().replace("\\", "/").removeprefix("./")
    ending = next((ending for ending in _ENDINGS if name.lower().endswith(ending)), "")
    return name[: len(name) - len(ending)]


def _rows(path: Path) -> Iterator[tuple[str, str, str]]:
    """Yield name, split and where in the list they stand."""
    if path.is_dir():
        lists = [file for file in sorted(path.glob("*.txt")) if file.stem.lower() in SPLIT_WORDS]
        if not lists:
            raise InputError("the folder holds no split list", where=path, remedy=_FORMS)
        for file in lists:
            for line, name in enumerate(_text(file).splitlines(), start=1):
                if name.strip():
                    yield name, file.stem, f"{file}, line {line}"
        return
    text = _text(path)
    if path.suffix.lower() == ".json":
        yield from _json_rows(text, path)
    else:
        yield from _csv_rows(text, path)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("the split list cannot be read", where=path, remedy=_FORMS) from error


def _json_rows(text: str, path: Path) -> Iterator[tuple[str, str, str]]:
    try:
        content = json.loads(text)
        if isinstance(content, dict) and all(isinstance(value, str) for value in content.values()):
            for name, word in _BY_NAME.validate_python(content).items():
                yield name, word, str(path)
        else:
            for word, names in _BY_SPLIT.validate_python(content).items():
                yield from ((name, word, str(path)) for name in names)
    except (ValueError, ValidationError) as error:
        raise InputError(
            f"the split list is not JSON of names by split ({str(error).splitlines()[0]})",
            where=path,
            remedy=_FORMS,
        ) from error


def _csv_rows(text: str, path: Path) -> Iterator[tuple[str, str, str]]:
    rows = [
        ([cell.strip() for cell in row], f"{path}, line {line}")
        for line, row in enumerate(csv.reader(text.splitlines()), start=1)
        if any(cell.strip() for cell in row)
    ]
    if not rows:
        raise InputError("the split list is empty", where=path, remedy=_FORMS)
    header = [cell.lower() for cell in rows[0][0]]
    name_at = next((header.index(name) for name in _NAME_COLUMNS if name in header), None)
    split_at = next((header.index(name) for name in _SPLIT_COLUMNS if name in header), None)
    if name_at is not None and split_at is not None:
        rows = rows[1:]
    elif len(header) == 2 and header[1] in SPLIT_WORDS:
        name_at, split_at = 0, 1
    else:
        raise InputError(
            f"the split list has the columns {', '.join(header)}", where=path, remedy=_FORMS
        )
    for row, where in rows:
        if len(row) <= max(name_at, split_at) or not row[name_at] or not row[split_at]:
            raise InputError(
                "the row has no name or no split", where=where, remedy="Complete or remove it"
            )
        yield row[name_at], row[split_at], where
