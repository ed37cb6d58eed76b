"""Folders of clips as plain arrays: TED Gesture (Yoon et al. 2020), and SHOW (Yi et al. 2023)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path, PurePosixPath

from motion.errors import InputError
from motion.formats.ted_npz import ARRAYS
from training.data.folder_files import SOUND_ENDINGS, FolderFiles, has_arrays
from training.data.found_take import (
    UNKNOWN_SPEAKER,
    Findings,
    FoundTake,
    each_take,
    sound_of,
    split_folder,
    transcript_of,
    usable_name,
    with_own_names,
)
from training.data.take import Split, Take

DATABASE = "data.mdb"
_CONVERT = "where you trust the file: docs/data.md shows how"


def find_ted(files: FolderFiles) -> Findings:
    """Return the takes of a folder of TED Gesture's clips, saved as plain arrays.

    A clip is ``talk/clip.npz`` (see `motion.formats.ted_npz`) with its sound beside it. A folder
    ``train``, ``val`` or ``test`` anywhere above it tells its split. Every talk is a speaker of its
    own. The databases that TED Gesture is distributed as are never opened, because reading them
    runs what is in them.
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
    found, skipped = each_take(files.ending_in(".npz"), partial(_ted_take, files))
    return _findings(found, [*databases, *skipped])


def find_show(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SHOW's clips, as distributed with TalkSHOW.

    A clip lies in ``speaker/video/clip/clip.npy`` (or ``.npz``), or without the folder of its own,
    with its sound beside it. A folder ``train``, ``val`` or ``test`` anywhere above it, as TalkSHOW
    sorts them, tells its split. Takes are named speaker and clip. The ``.pkl`` files that SHOW is
    distributed as are never opened, because reading one runs what is in it.
    """
    found, skipped = each_take(files.ending_in(".npy", ".npz"), partial(_show_take, files))
    pickled = [
        InputError(
            "the motion is pickled, not a plain array",
            where=path,
            remedy=f"Save its arrays once with numpy.savez, {_CONVERT}",
        )
        for path in files.ending_in(".pkl")
        if files.companion(path, SOUND_ENDINGS) and not files.companion(path, (".npy", ".npz"))
    ]
    return _findings(found, [*skipped, *pickled])


def _findings(found: Sequence[FoundTake], skipped: Iterable[InputError]) -> Findings:
    takes = with_own_names(found)
    return Findings(
        takes=takes,
        skipped=tuple(skipped),
        speakers=tuple(sorted({one.take.speaker for one in takes})),
        split_rule="the folders train, val and test",
    )


def _ted_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if not has_arrays(motion, *ARRAYS):
        if files.companion(motion, SOUND_ENDINGS):
            raise InputError(
                "the file holds no motion of TED Gesture",
                where=motion,
                remedy=f"Give one of the arrays {', '.join(ARRAYS)}",
            )
        return None
    place, split = split_folder(files.place_of(motion).with_suffix(""))
    above = place.parent.parts
    return _placed(files, motion, place, place.parent if above else place, above[-1:], split)


def _show_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if files.companion(motion, SOUND_ENDINGS) is None and motion.suffix.lower() == ".npz":
        # Statistics and other arrays lie beside data sets.
        return None
    place, split = split_folder(files.place_of(motion).with_suffix(""))
    if len(place.parts) > 1 and place.parts[-1] == place.parts[-2]:
        place = place.parent
    above = place.parent.parts
    recording = place.parent if len(above) > 1 else place
    return _placed(files, motion, place, recording, above[:1], split)


def _placed(
    files: FolderFiles,
    motion: Path,
    place: PurePosixPath,
    recording: PurePosixPath,
    speaker: tuple[str, ...],
    split: Split | None,
) -> FoundTake:
    """Return the clip at `place`, said by the one `speaker` whose folder it is in, if any."""
    take = Take(
        name=usable_name("_".join((*speaker, place.name))),
        speaker=speaker[0] if speaker else UNKNOWN_SPEAKER,
        emotion="",
        split="train",
        speech=sound_of(motion, files),
        motion=motion,
        transcript=transcript_of(motion, files),
    )
    return FoundTake(
        take=take, place=place.as_posix(), recording=recording.as_posix(), given_split=split
    )
