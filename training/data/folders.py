"""Finding the takes of a folder of any known layout.

Clips as plain arrays are those of TED Gesture (Yoon et al. 2020) and SHOW (Yi et al. 2023).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path, PurePosixPath
from typing import Final

from motion.endings import SPEECH_ENDINGS
from motion.errors import InputError, listed
from motion.formats.smplx_rows import ARRAYS as SHOW_ARRAYS
from motion.formats.ted_npz import ARRAYS as TED_ARRAYS
from training.data.beat import find_beat, find_beat2
from training.data.found_take import (
    UNKNOWN_SPEAKER,
    Findings,
    FolderFiles,
    FoundTake,
    each_take,
    found_take,
    has_arrays,
    list_folder,
    split_folder,
    with_unique_names,
)
from training.data.splitting import USUAL_NAMES, by_list, by_rule, read_split_list
from training.data.take import KINDS, Kind, Split, TakeFolder

DATABASE = "data.mdb"
_CONVERT = "if you trust the file: docs/data.md shows how"


def find_ted(files: FolderFiles) -> Findings:
    """Return the takes of a folder of TED Gesture's clips, saved as plain arrays.

    A clip is ``talk/clip.npz`` (see `motion.formats.ted_npz`) with its sound next to it. A folder
    ``train``, ``val`` or ``test`` above it names its split. Every talk counts as one speaker. TED
    Gesture's own databases are never opened, because unpickling them runs code.
    """
    databases = [
        InputError(
            "the database holds pickled Python objects, not plain arrays",
            where=path,
            remedy=f"Save its clips once as .npz and .wav, {_CONVERT}",
        )
        for path in files.files
        if path.name == DATABASE
    ]
    takes, skipped = each_take(files.ending_in(".npz"), partial(_ted_take, files))
    return _findings(takes, [*databases, *skipped])


def find_show(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SHOW's clips, as distributed with TalkSHOW.

    A clip is ``speaker/video/clip/clip.npy`` (or ``.npz``) or ``speaker/video/clip.npy``, with its
    sound next to it. A folder ``train``, ``val`` or ``test`` above it names its split. Takes are
    named after speaker and clip. SHOW's own ``.pkl`` files are never opened, because unpickling
    them runs code.
    """
    takes, skipped = each_take(files.ending_in(".npy", ".npz"), partial(_show_take, files))
    pickled = [
        InputError(
            "the motion is pickled, not a plain array",
            where=path,
            remedy=f"Save its arrays once with numpy.savez, {_CONVERT}",
        )
        for path in files.ending_in(".pkl")
        if files.companion(path, SPEECH_ENDINGS) and not files.companion(path, (".npy", ".npz"))
    ]
    return _findings(takes, [*skipped, *pickled])


def _findings(takes: Sequence[FoundTake], skipped: Iterable[InputError]) -> Findings:
    unique = with_unique_names(takes)
    return Findings(
        takes=unique,
        skipped=tuple(skipped),
        speakers=tuple(sorted({item.take.speaker for item in unique})),
        split_rule="the folders train, val and test",
    )


def _ted_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if not has_arrays(motion, *TED_ARRAYS):
        if files.companion(motion, SPEECH_ENDINGS):
            raise InputError(
                "the file holds no motion of TED Gesture",
                where=motion,
                remedy=f"Give one of the arrays {', '.join(TED_ARRAYS)}",
            )
        return None
    place, split = split_folder(files.place_of(motion).with_suffix(""))
    recording = place.parent if place.parent.parts else place
    return _clip_take(files, motion, place, recording, place.parent.parts[-1:], split)


def _show_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if files.companion(motion, SPEECH_ENDINGS) is None and motion.suffix.lower() == ".npz":
        # Data sets come with statistics and other arrays.
        return None
    place, split = split_folder(files.place_of(motion).with_suffix(""))
    if len(place.parts) > 1 and place.parts[-1] == place.parts[-2]:
        place = place.parent
    outer = place.parent.parts
    recording = place.parent if len(outer) > 1 else place
    return _clip_take(files, motion, place, recording, outer[:1], split)


def _clip_take(
    files: FolderFiles,
    motion: Path,
    place: PurePosixPath,
    recording: PurePosixPath,
    speaker: tuple[str, ...],
    split: Split | None,
) -> FoundTake:
    """Return the clip at `place`; `speaker` is empty if no folder names one."""
    return found_take(
        files,
        motion,
        place,
        name="_".join((*speaker, place.name)),
        speaker=speaker[0] if speaker else UNKNOWN_SPEAKER,
        recording=recording.as_posix(),
        given_split=split,
    )


_READERS: Final[Mapping[Kind, Callable[[FolderFiles], Findings]]] = {
    "beat": find_beat,
    "beat2": find_beat2,
    "show": find_show,
    "ted": find_ted,
}


def read_takes(
    folder: Path, *, kind: str | None = None, split_list: Path | None = None
) -> TakeFolder:
    """Find the takes in a folder of recordings; the files are read when features are computed.

    Parameters
    ----------
    folder : Path
        The data set as downloaded, or recordings in the same layout.
    kind : {'beat', 'beat2', 'show', 'ted'}, optional
        The folder's layout; by default recognised from the files.
    split_list : Path, optional
        A list for `training.data.splitting.read_split_list`. The default is the folder's own list,
        or else the data set's rule, or else a hash of each recording's name.

    Returns
    -------
    TakeFolder
        `TakeFolder.skipped` explains which takes cannot be used.

    Raises
    ------
    InputError
        If the folder is missing, has no known layout or no takes, or the split list is unusable.
    """
    files = list_folder(folder)
    layout = _kind_of(files) if kind is None else _checked_kind(kind)
    findings = _READERS[layout](files)
    if not findings.takes:
        raise InputError(
            f"the folder holds no take of {layout}"
            + (
                f"; the first of {len(findings.skipped)} files is not a take because "
                f"{findings.skipped[0].what}"
                if findings.skipped
                else ""
            ),
            where=folder,
            remedy=findings.skipped[0].remedy if findings.skipped else "See docs/data.md",
        )
    list_path = split_list or next(
        (folder / name for name in USUAL_NAMES if (folder / name).is_file()), None
    )
    takes, notes = by_list(findings, read_split_list(list_path)) if list_path else by_rule(findings)
    speakers = {take.speaker for take in takes}
    return TakeFolder(
        kind=layout,
        takes=tuple(sorted(takes, key=lambda take: take.name)),
        speakers=tuple(speaker for speaker in findings.speakers if speaker in speakers),
        skipped=findings.skipped,
        notes=notes,
    )


def _checked_kind(kind: str) -> Kind:
    for layout in KINDS:
        if kind == layout:
            return layout
    raise InputError(f"there is no layout {kind!r}", remedy=f"Use one of {listed(KINDS)}")


def _kind_of(files: FolderFiles) -> Kind:
    """Return the layout of the files."""
    if any(files.ending_in(".bvh")):
        return "beat"
    kinds: set[Kind] = set()
    if any(path.name == DATABASE for path in files.files):
        kinds.add("ted")
    if any(files.companion(path, SPEECH_ENDINGS) for path in files.ending_in(".npy", ".pkl")):
        kinds.add("show")
    for path in files.ending_in(".npz"):
        if files.companion(path, SPEECH_ENDINGS):
            kinds |= _kinds_of_archive(path)
    if len(kinds) == 1:
        return kinds.pop()
    problem = (
        f"the folder may be {listed(sorted(kinds))}"
        if kinds
        else "the folder holds no recordings of a known layout"
    )
    raise InputError(
        problem,
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
