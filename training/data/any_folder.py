"""Reading a folder of recordings of any known layout."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.formats.smplx_rows import ARRAYS as SHOW_ARRAYS
from motion.formats.ted_npz import ARRAYS as TED_ARRAYS
from motion.listing import listed
from training.data.beat_folder import find_beat, find_beat2
from training.data.clip_folder import DATABASE, find_show, find_ted
from training.data.folder_files import SOUND_ENDINGS, FolderFiles, has_arrays, list_folder
from training.data.found_take import Findings
from training.data.split_list import USUAL_NAMES, read_split_list
from training.data.splitting import by_list, by_rule
from training.data.take import KINDS, Kind, TakeFolder

_READERS: Final[Mapping[Kind, Callable[[FolderFiles], Findings]]] = {
    "beat": find_beat,
    "beat2": find_beat2,
    "show": find_show,
    "ted": find_ted,
}


def read_takes(
    folder: Path, *, kind: str | None = None, split_list: Path | None = None
) -> TakeFolder:
    """Find the takes in a folder of recordings.

    What is in the files is looked at later, when features are computed of it.

    Parameters
    ----------
    folder : Path
        The data set as downloaded, or recordings in the same layout.
    kind : {'beat', 'beat2', 'show', 'ted'}, optional
        Its layout; by default what its files look like.
    split_list : Path, optional
        Says which take is for what, see `training.data.split_list`; by default the folder's own
        list, then the rule of the data set, then a hash of each recording's name.

    Returns
    -------
    TakeFolder
        Takes that cannot be used are named in `TakeFolder.skipped`.

    Raises
    ------
    InputError
        If the folder is missing, of no known layout, holds no take, or the split list is unusable.
    """
    files = list_folder(folder)
    known = _kind_of(files) if kind is None else _checked_kind(kind)
    findings = _READERS[known](files)
    if not findings.takes:
        raise InputError(
            f"the folder holds no take of {known}"
            + (
                f"; the first of {len(findings.skipped)} files is not a take because "
                f"{findings.skipped[0].what}"
                if findings.skipped
                else ""
            ),
            where=folder,
            remedy=findings.skipped[0].remedy if findings.skipped else "See docs/data.md",
        )
    given = split_list or next(
        (folder / name for name in USUAL_NAMES if (folder / name).is_file()), None
    )
    takes, notes = by_list(findings, read_split_list(given)) if given else by_rule(findings)
    speaking = {take.speaker for take in takes}
    return TakeFolder(
        kind=known,
        takes=tuple(sorted(takes, key=lambda take: take.name)),
        speakers=tuple(speaker for speaker in findings.speakers if speaker in speaking),
        skipped=findings.skipped,
        notes=notes,
    )


def _checked_kind(kind: str) -> Kind:
    for known in KINDS:
        if kind == known:
            return known
    raise InputError(f"there is no layout {kind!r}", remedy=f"Use one of {listed(KINDS)}")


def _kind_of(files: FolderFiles) -> Kind:
    """Return the layout that the files look like."""
    if any(files.ending_in(".bvh")):
        return "beat"
    kinds: set[Kind] = set()
    if any(path.name == DATABASE for path in files.files):
        kinds.add("ted")
    if any(files.companion(path, SOUND_ENDINGS) for path in files.ending_in(".npy", ".pkl")):
        kinds.add("show")
    for path in files.ending_in(".npz"):
        if files.companion(path, SOUND_ENDINGS):
            kinds |= _kinds_of_archive(path)
    if len(kinds) == 1:
        return kinds.pop()
    what = (
        f"the folder may be {listed(sorted(kinds))}"
        if kinds
        else "the folder holds no recordings of a known layout"
    )
    raise InputError(
        what,
        where=files.root,
        remedy=f"Name its layout, one of {listed(KINDS)}, or see docs/data.md for what each is",
    )


def _kinds_of_archive(path: Path) -> set[Kind]:
    arrays: Mapping[Kind, tuple[str, ...]] = {
        "beat2": ("poses",),
        "show": SHOW_ARRAYS,
        "ted": TED_ARRAYS,
    }
    try:
        return {kind for kind, keys in arrays.items() if has_arrays(path, *keys)}
    except InputError:
        return set()
