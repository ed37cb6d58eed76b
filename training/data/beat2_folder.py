"""BEAT2 (Liu et al. 2024), and any folder of SMPL-X ``.npz`` files and sound of the same names."""

from __future__ import annotations

from pathlib import Path

from motion.errors import InputError
from training.data.beat_folder import SPLIT_RULE, beat_speakers, lonely_sounds
from training.data.beat_names import BeatName
from training.data.folder_files import SOUND_ENDINGS, FolderFiles, has_arrays
from training.data.found_take import (
    UNKNOWN_SPEAKER,
    Findings,
    FoundTake,
    sound_of,
    split_folder,
    transcript_of,
    usable_name,
    without_doubles,
)
from training.data.take import Take


def find_beat2(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SMPL-X motion and sound.

    Every ``.npz`` with poses is a take; its sound has the same name, beside it or in another
    folder, as BEAT2 keeps motion in ``smplxflame_30``, sound in ``wave16k`` and annotated gestures
    in ``sem``. Names tell speaker and emotion where they are BEAT's; else the folder that holds
    motion and sound is the speaker's.
    """
    found: list[FoundTake] = []
    skipped: list[InputError] = []
    for motion in files.ending_in(".npz"):
        try:
            if has_arrays(motion, "poses"):
                found.append(_take(motion, files))
            elif files.companion(motion, SOUND_ENDINGS):
                raise InputError(
                    "the file holds no poses", where=motion, remedy="Give SMPL-X poses in it"
                )
        except InputError as error:
            skipped.append(error)
    skipped += lonely_sounds(files, ".npz")
    takes, doubles = without_doubles(found)
    return Findings(
        takes=takes,
        skipped=(*skipped, *doubles),
        speakers=beat_speakers(one.take for one in takes),
        split_rule=SPLIT_RULE,
    )


def _take(motion: Path, files: FolderFiles) -> FoundTake:
    speech = sound_of(motion, files)
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    name = BeatName.parse(motion.stem)
    beside = speech.parent == motion.parent and len(place.parts) > 1
    speaker = name.speaker if name else place.parts[-2] if beside else UNKNOWN_SPEAKER
    take = Take(
        name=usable_name(motion.stem),
        speaker=speaker,
        emotion=name.emotion if name else "",
        split="train",
        speech=speech,
        motion=motion,
        semantic=files.companion(motion, (".txt",)),
        transcript=transcript_of(motion, files),
    )
    return FoundTake(
        take=take,
        place=place.as_posix(),
        recording=motion.stem,
        given_split=folder_split or (name.published_split if name else None),
    )
