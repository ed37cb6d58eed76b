"""SHOW as distributed with TalkSHOW (Yi et al. 2023), its motion saved as plain arrays."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from motion.errors import InputError
from training.data.folder_files import SOUND_ENDINGS, FolderFiles
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

_CONVERT = "Save its arrays once with numpy.savez, where you trust the file: docs/data.md shows how"


def find_show(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SHOW's clips.

    A clip lies in ``speaker/video/clip/clip.npy`` (or ``.npz``), or without the folder of its own,
    with its sound beside it. A folder ``train``, ``val`` or ``test`` anywhere above it, as TalkSHOW
    sorts them, tells its split. Takes are named speaker and clip. The ``.pkl`` files that SHOW is
    distributed as are never opened, because reading one runs what is in it.
    """
    found: list[FoundTake] = []
    skipped: list[InputError] = []
    for motion in files.ending_in(".npy", ".npz"):
        if files.companion(motion, SOUND_ENDINGS) is None and motion.suffix.lower() == ".npz":
            # Statistics and other arrays lie beside data sets.
            continue
        try:
            found.append(_take(motion, files))
        except InputError as error:
            skipped.append(error)
    for pickled in files.ending_in(".pkl"):
        has_sound = files.companion(pickled, SOUND_ENDINGS) is not None
        if has_sound and files.companion(pickled, (".npy", ".npz")) is None:
            skipped.append(
                InputError(
                    "the motion is pickled, not a plain array", where=pickled, remedy=_CONVERT
                )
            )
    takes = with_own_names(found)
    return Findings(
        takes=takes,
        skipped=tuple(skipped),
        speakers=tuple(sorted({one.take.speaker for one in takes})),
        split_rule="the folders train, val and test",
    )


def _take(motion: Path, files: FolderFiles) -> FoundTake:
    speech = sound_of(motion, files)
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    if len(place.parts) > 1 and place.parts[-1] == place.parts[-2]:
        place = place.parent
    above = place.parent.parts
    speaker = above[0] if above else UNKNOWN_SPEAKER
    take = Take(
        name=usable_name(f"{speaker}_{place.name}" if above else place.name),
        speaker=speaker,
        emotion="",
        split="train",
        speech=speech,
        motion=motion,
        transcript=transcript_of(motion, files),
    )
    recording = place.parent if len(above) > 1 else PurePosixPath(place)
    return FoundTake(
        take=take,
        place=place.as_posix(),
        recording=recording.as_posix(),
        given_split=folder_split,
    )
