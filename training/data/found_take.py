"""Which files a folder of recordings holds, and which takes readers of data sets find in them.

It is not settled yet which take is for what.
"""

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

from motion.errors import InputError
from motion.formats.transcript import preferred_transcript
from training.data.take import Split, Take

SOUND_ENDINGS: Final = (".wav", ".flac", ".mp3", ".m4a", ".ogg")
"""In the order in which they are preferred."""


@dataclass(frozen=True, kw_only=True)
class FolderFiles:
    """All files below a folder.

    Attributes
    ----------
    root : Path
        The folder.
    files : tuple of Path
        In order; hidden ones, and what lies in hidden folders, left out.
    """

    root: Path
    files: tuple[Path, ...]

    def ending_in(self, *endings: str) -> Iterator[Path]:
        """Yield the files with one of these endings, whatever their case."""
        return (path for path in self.files if path.suffix.lower() in endings)

    def place_of(self, path: Path) -> PurePosixPath:
        """Return where `path` lies below the folder."""
        return PurePosixPath(path.relative_to(self.root).as_posix())

    def companion(self, path: Path, endings: Iterable[str]) -> Path | None:
        """Return the file that has the name of `path` and one of `endings`.

        The first ending of which there is one beside `path`, or else one anywhere in the folder,
        as data sets keep sound and motion apart. None where there is none, or where several could
        be meant.
        """
        for ending in endings:
            named = self._by_name.get((path.stem, ending), [])
            beside = [other for other in named if other.parent == path.parent]
            if beside or len(named) == 1:
                return (beside or named)[0]
        return None

    @cached_property
    def _by_name(self) -> Mapping[tuple[str, str], list[Path]]:
        found: dict[tuple[str, str], list[Path]] = {}
        for path in self.files:
            found.setdefault((path.stem, path.suffix.lower()), []).append(path)
        return found


def list_folder(root: Path) -> FolderFiles:
    """Return all files below `root`; links to folders are followed, each folder once.

    Raises
    ------
    InputError
        If there is no such folder.
    """
    if not root.is_dir():
        raise InputError("there is no such folder of recordings", where=root, remedy="Check it")
    seen: set[str] = set()
    files: list[Path] = []
    for folder, below, names in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if not name.startswith("."))
        files += (Path(folder) / name for name in names if not name.startswith("."))
    return FolderFiles(root=root, files=tuple(sorted(files)))


def has_arrays(path: Path, *keys: str) -> bool:
    """Return whether an ``.npz`` file holds one of `keys`.

    Raises
    ------
    InputError
        If the file is no such archive.
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
"""How data sets call the splits, in lower case."""

UNKNOWN_SPEAKER: Final = "unknown"
"""Who speaks where a data set does not say."""

_LONGEST_NAME: Final = 100


@dataclass(frozen=True, kw_only=True)
class FoundTake:
    """A take, and what may decide which split it belongs to.

    Attributes
    ----------
    take : Take
        Its split is not settled.
    place : str
        Where it lies below the folder, without the ending of its file and without the folder of a
        split: the other name, besides its own, by which a split list may call it.
    recording : str
        What it was cut from: takes of one recording belong to one split.
    given_split : {'train', 'validation', 'test'} or None
        The split that the data set itself puts it in, by a folder or a published rule.
    """

    take: Take
    place: str
    recording: str
    given_split: Split | None = None


@dataclass(frozen=True, kw_only=True)
class Findings:
    """What a reader found in a folder.

    Attributes
    ----------
    takes : tuple of FoundTake
        In no particular order; their names differ.
    skipped : tuple of InputError
        What is no usable take, and why.
    speakers : tuple of str
        Everybody who speaks, in the order of the data set.
    split_rule : str
        Whose splits `FoundTake.given_split` are, in words; empty where there are none.
    """

    takes: tuple[FoundTake, ...]
    skipped: tuple[InputError, ...]
    speakers: tuple[str, ...]
    split_rule: str = ""


def each_take(
    motions: Iterable[Path], take_of: Callable[[Path], FoundTake | None]
) -> tuple[list[FoundTake], list[InputError]]:
    """Return the takes of motion files, and why others are none.

    `take_of` returns None for a file that is no motion at all.
    """
    found: list[FoundTake] = []
    skipped: list[InputError] = []
    for motion in motions:
        try:
            take = take_of(motion)
        except InputError as error:
            skipped.append(error)
        else:
            found += [take] if take else []
    return found, skipped


def sound_of(motion: Path, files: FolderFiles) -> Path:
    """Return the sound that belongs to a file of motion.

    Raises
    ------
    InputError
        If there is none, or a file is empty.
    """
    sound = files.companion(motion, SOUND_ENDINGS)
    if sound is None:
        raise InputError(
            "the motion has no sound",
            where=motion,
            remedy=f"Put {motion.stem}.wav beside it",
        )
    for path in (motion, sound):
        if not path.stat().st_size:
            raise InputError("the file is empty", where=path, remedy="Copy it again")
    return sound


def transcript_of(motion: Path, files: FolderFiles) -> Path | None:
    """Return the file that tells what is said to a file of motion, where there is one."""
    return preferred_transcript(lambda ending: files.companion(motion, (ending,)))


def split_folder(place: PurePosixPath) -> tuple[PurePosixPath, Split | None]:
    """Return `place` without a folder that names a split, and that split."""
    for index, part in enumerate(place.parts[:-1]):
        if part.lower() in SPLIT_WORDS:
            rest = PurePosixPath(*place.parts[:index], *place.parts[index + 1 :])
            return rest, SPLIT_WORDS[part.lower()]
    return place, None


def usable_name(text: str, *, marked: bool = False) -> str:
    """Return `text` as a name that is safe as a file name.

    Where letters had to be replaced, or `marked`, it ends in a hash of `text`.
    """
    name = re.sub(r"[^A-Za-z0-9_.-]+", "_", text).lstrip("_.-")
    if name == text and len(name) <= _LONGEST_NAME and not marked:
        return name
    mark = hashlib.sha256(text.encode()).hexdigest()[:8]
    return f"{name[: _LONGEST_NAME - 9] or 'take'}-{mark}"


def with_own_names(found: Sequence[FoundTake]) -> tuple[FoundTake, ...]:
    """Return the takes; those that share a name get one that tells where they lie."""
    times = Counter(one.take.name for one in found)
    return tuple(
        replace(one, take=replace(one.take, name=usable_name(one.place, marked=True)))
        if times[one.take.name] > 1
        else one
        for one in found
    )


def without_doubles(
    found: Iterable[FoundTake],
) -> tuple[tuple[FoundTake, ...], tuple[InputError, ...]]:
    """Return the takes without those whose name an earlier one has, and what to say of these."""
    kept: dict[str, FoundTake] = {}
    doubles: list[InputError] = []
    for one in found:
        first = kept.setdefault(one.take.name, one)
        if first is not one:
            doubles.append(
                InputError(
                    f"take {one.take.name} is there twice; {first.take.motion} is used",
                    where=one.take.motion,
                    remedy="Rename or remove one of them",
                )
            )
    return tuple(kept.values()), tuple(doubles)
