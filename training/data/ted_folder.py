"""TED Gesture (Yoon et al. 2020): the upper body of speakers in talks, as plain arrays."""

from __future__ import annotations

from pathlib import Path

from motion.errors import InputError
from motion.formats.ted_npz import ARRAYS
from training.data.folder_files import SOUND_ENDINGS, FolderFiles, has_arrays
from training.data.found_take import (
    UNKNOWN_SPEAKER,
    Findings,
    FoundTake,
    sound_of,
    split_folder,
    transcript_of,
    usable_name,
    with_own_names,
)
from training.data.take import Take

DATABASE = "data.mdb"


def find_ted(files: FolderFiles) -> Findings:
    """Return the takes of a folder of TED Gesture's clips, saved as plain arrays.

    A clip is ``talk/clip.npz`` (see `motion.formats.ted_npz`) with its sound beside it. A folder
    ``train``, ``val`` or ``test`` anywhere above it tells its split. Every talk is a speaker of its
    own. The databases that TED Gesture is distributed as are never opened, because reading them
    runs what is in them.
    """
    found: list[FoundTake] = []
    skipped = [
        InputError(
            "the database holds pickled Python objects, not plain arrays",
            where=path,
            remedy="Save its clips once as .npz and .wav, where you trust the file: docs/data.md "
            "shows how",
        )
        for path in files.files
        if path.name == DATABASE
    ]
    for motion in files.ending_in(".npz"):
        try:
            if has_arrays(motion, *ARRAYS):
                found.append(_take(motion, files))
            elif files.companion(motion, SOUND_ENDINGS):
                raise InputError(
                    "the file holds no motion of TED Gesture",
                    where=motion,
                    remedy=f"Give one of the arrays {', '.join(ARRAYS)}",
                )
        except InputError as error:
            skipped.append(error)
    takes = with_own_names(found)
    return Findings(
        takes=takes,
        skipped=tuple(skipped),
        speakers=tuple(sorted({one.take.speaker for one in takes})),
        split_rule="the folders train, val and test",
    )


def _take(motion: Path, files: FolderFiles) -> FoundTake:
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    above = place.parent.parts
    speaker = above[-1] if above else UNKNOWN_SPEAKER
    take = Take(
        name=usable_name(f"{speaker}_{place.name}" if above else place.name),
        speaker=speaker,
        emotion="",
        split="train",
        speech=sound_of(motion, files),
        motion=motion,
        transcript=transcript_of(motion, files),
    )
    return FoundTake(
        take=take,
        place=place.as_posix(),
        recording=(place.parent if above else place).as_posix(),
        given_split=folder_split,
    )
