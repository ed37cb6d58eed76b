"""The files of a folder of recordings, and the takes found in it before they are split."""

from __future__ import annotations

import hashlib
import os
import re
import zipfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Final

from motion.endings import SPEECH_ENDINGS
from motion.errors import InputError
from motion.formats.transcript import preferred_transcript
from training.data.take import Split, Take


@dataclass(frozen=True, kw_only=True)
class FolderFiles:
    """All files below a folder.

    Attributes
    ----------
    root : Path
        The folder.
    files : tuple of Path
        Sorted paths, without hidden files and folders.
    """

    root: Path
    files: tuple[Path, ...]

    def ending_in(self, *endings: str) -> Iterator[Path]:
        """Yield the files with one of `endings`, whatever their case."""
        return (path for path in self.files if path.suffix.lower() in endings)

    def place_of(self, path: Path) -> PurePosixPath:
        """Return the path of a file relative to the folder."""
        return PurePosixPath(path.relative_to(self.root).as_posix())

    def companion(self, path: Path, endings: Iterable[str]) -> Path | None:
        """Return the file with the stem of `path` and the first of `endings` that exists.

        It is next to `path` or anywhere in the folder, since data sets separate sound and motion.
        None if there is no such file, or several outside the folder of `path`.
        """
        for ending in endings:
            candidates = self._by_name.get((path.stem, ending), [])
            siblings = [candidate for candidate in candidates if candidate.parent == path.parent]
            if siblings or len(candidates) == 1:
                return (siblings or candidates)[0]
        return None

    @cached_property
    def _by_name(self) -> Mapping[tuple[str, str], list[Path]]:
        by_name: dict[tuple[str, str], list[Path]] = {}
        for path in self.files:
            by_name.setdefault((path.stem, path.suffix.lower()), []).append(path)
        return by_name


def list_folder(root: Path) -> FolderFiles:
    """Return all files below `root`; links to folders are followed once.

    Raises
    ------
    InputError
        If there is no such folder.
    """
    if not root.is_dir():
        raise InputError("there is no such folder of recordings", where=root, remedy="Check it")
    seen: set[str] = set()
    files: list[Path] = []
    for folder, subfolders, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            subfolders.clear()
            continue
        seen.add(real)
        subfolders[:] = sorted(name for name in subfolders if not name.startswith("."))
        files += (Path(folder) / name for name in names if not name.startswith("."))
    return FolderFiles(root=root, files=tuple(sorted(files)))


def has_arrays(path: Path, *keys: str) -> bool:
    """Return whether an ``.npz`` file has one of `keys`.

    Raises
    ------
    InputError
        If the file is not an archive.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return any(f"{key}.npy" in archive.namelist() for key in keys)
    except (OSError, zipfile.BadZipFile) as error:
        raise InputError(
            "the file is not an .npz archive, or is truncated", where=path, remedy="Copy it again"
        ) from error


SPLIT_WORDS: Final[dict[str, Split]] = {
    "train": "train",
    "training": "train",
    "val": "validation",
    "valid": "validation",
    "validation": "validation",
    "dev": "validation",
    "test": "test",
    "testing": "test",
}
"""Data sets' names of the splits, in lower case."""

UNKNOWN_SPEAKER: Final = "unknown"
"""The speaker of takes whose data set names none."""

_LONGEST_NAME: Final = 100


@dataclass(frozen=True, kw_only=True)
class FoundTake:
    """A take whose split is undecided, with the facts that may decide it.

    Attributes
    ----------
    take : Take
        The take, with a provisional split.
    place : str
        Its path in the folder, without its ending and the folder of a split. A split list may use
        it instead of the name.
    recording : str
        The recording that it was cut from; takes of one recording belong to one split.
    given_split : {'train', 'validation', 'test'} or None
        The data set's own split, by a folder or a published rule.
    """

    take: Take
    place: str
    recording: str
    given_split: Split | None = None


@dataclass(frozen=True, kw_only=True)
class Findings:
    """The takes of a folder.

    Attributes
    ----------
    takes : tuple of FoundTake
        The takes in no particular order, with unique names.
    skipped : tuple of InputError
        Why other files are not takes.
    speakers : tuple of str
        All speakers, in the order of the data set.
    split_rule : str
        The source of `FoundTake.given_split`, in words; empty if there is none.
    """

    takes: tuple[FoundTake, ...]
    skipped: tuple[InputError, ...]
    speakers: tuple[str, ...]
    split_rule: str = ""


def each_take(
    motions: Iterable[Path], take_of: Callable[[Path], FoundTake | None]
) -> tuple[list[FoundTake], list[InputError]]:
    """Return the takes of motion files, and why other files are not takes.

    `take_of` returns None for a file that holds no motion.
    """
    takes: list[FoundTake] = []
    skipped: list[InputError] = []
    for motion in motions:
        try:
            take = take_of(motion)
        except InputError as error:
            skipped.append(error)
        else:
            takes += [take] if take else []
    return takes, skipped


def found_take(
    files: FolderFiles,
    motion: Path,
    place: PurePosixPath,
    *,
    name: str,
    speaker: str,
    recording: str,
    given_split: Split | None,
    emotion: str = "",
    **tracks: Path | None,
) -> FoundTake:
    """Return the take at `place`, with its sound and its transcript, and with further `tracks`.

    Raises
    ------
    InputError
        If there is no sound, or a file is empty.
    """
    take = Take(
        name=usable_name(name),
        speaker=speaker,
        emotion=emotion,
        split="train",
        speech=sound_of(motion, files),
        motion=motion,
        transcript=preferred_transcript(lambda ending: files.companion(motion, (ending,))),
        **tracks,
    )
    return FoundTake(
        take=take, place=place.as_posix(), recording=recording, given_split=given_split
    )


def sound_of(motion: Path, files: FolderFiles) -> Path:
    """Return the sound of a motion file.

    Raises
    ------
    InputError
        If there is no sound, or a file is empty.
    """
    sound = files.companion(motion, SPEECH_ENDINGS)
    if sound is None:
        raise InputError(
            "the motion has no sound",
            where=motion,
            remedy=f"Put {motion.stem}.wav next to it",
        )
    for path in (motion, sound):
        if not path.stat().st_size:
            raise InputError("the file is empty", where=path, remedy="Copy it again")
    return sound


def split_folder(place: PurePosixPath) -> tuple[PurePosixPath, Split | None]:
    """Return `place` without a folder that names a split, and that split."""
    for index, part in enumerate(place.parts[:-1]):
        if part.lower() in SPLIT_WORDS:
            remaining = PurePosixPath(*place.parts[:index], *place.parts[index + 1 :])
            return remaining, SPLIT_WORDS[part.lower()]
    return place, None


def usable_name(text: str, *, marked: bool = False) -> str:
    """Return `text` as a safe file name.

    A hash of `text` is appended if `text` had to be changed, or if `marked`.
    """
    name = re.sub(r"[^A-Za-z0-9_.-]+", "_", text).lstrip("_.-")
    if name == text and len(name) <= _LONGEST_NAME and not marked:
        return name
    mark = hashlib.sha256(text.encode()).hexdigest()[:8]
    return f"{name[: _LONGEST_NAME - 9] or 'take'}-{mark}"


def with_unique_names(takes: Sequence[FoundTake]) -> tuple[FoundTake, ...]:
    """Return the takes; takes that share a name are renamed after their place."""
    counts = Counter(item.take.name for item in takes)
    return tuple(
        replace(item, take=replace(item.take, name=usable_name(item.place, marked=True)))
        if counts[item.take.name] > 1
        else item
        for item in takes
    )


def without_duplicates(
    takes: Iterable[FoundTake],
) -> tuple[tuple[FoundTake, ...], tuple[InputError, ...]]:
    """Return the first take of each name, and an error for each other take."""
    by_name: dict[str, FoundTake] = {}
    duplicates: list[InputError] = []
    for item in takes:
        first = by_name.setdefault(item.take.name, item)
        if first is not item:
            duplicates.append(
                InputError(
                    f"take {item.take.name} exists twice; {first.take.motion} is used",
                    where=item.take.motion,
                    remedy="Rename or remove one of them",
                )
            )
    return tuple(by_name.values()), tuple(duplicates)
