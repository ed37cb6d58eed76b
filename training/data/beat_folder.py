"""BEAT as downloaded (Liu et al. 2022): BVH, sound, facial weights, take by take."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from motion.errors import InputError
from training.data.beat_names import BeatName
from training.data.folder_files import FolderFiles
from training.data.found_take import (
    Findings,
    FoundTake,
    sound_of,
    split_folder,
    transcript_of,
    without_doubles,
)
from training.data.take import Take

SPLIT_RULE = "the rule published with BEAT"


def find_beat(files: FolderFiles) -> Findings:
    """Return the takes of a folder that holds BEAT's recordings, in folders or flat.

    Every ``.bvh`` is a take; sound (``.wav``), facial weights (``.json``) and annotated gestures
    (``.txt``) have its name. The last two may be missing.
    """
    found: list[FoundTake] = []
    skipped: list[InputError] = []
    for motion in files.ending_in(".bvh"):
        try:
            found.append(_take(motion, files))
        except InputError as error:
            skipped.append(error)
    skipped += lonely_sounds(files, ".bvh")
    takes, doubles = without_doubles(found)
    return Findings(
        takes=takes,
        skipped=(*skipped, *doubles),
        speakers=beat_speakers(one.take for one in takes),
        split_rule=SPLIT_RULE,
    )


def _take(motion: Path, files: FolderFiles) -> FoundTake:
    name = BeatName.parse(motion.stem)
    if name is None:
        raise InputError(
            "the file is not named as BEAT names its takes",
            where=motion,
            remedy="Name it {number}_{name}_{type}_{start}_{end}, such as 2_scott_0_9_9",
        )
    take = Take(
        name=motion.stem,
        speaker=name.speaker,
        emotion=name.emotion,
        split="train",
        speech=sound_of(motion, files),
        motion=motion,
        face=files.companion(motion, (".json",)),
        semantic=files.companion(motion, (".txt",)),
        transcript=transcript_of(motion, files),
    )
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    return FoundTake(
        take=take,
        place=place.as_posix(),
        recording=motion.stem,
        given_split=folder_split or name.published_split,
    )


def lonely_sounds(files: FolderFiles, *endings: str) -> list[InputError]:
    """Return what to say of sound that BEAT would name so, and that has no motion."""
    return [
        InputError(
            "the sound has no motion",
            where=sound,
            remedy=f"Put {sound.stem}{endings[0]} beside it",
        )
        for sound in files.ending_in(".wav")
        if BeatName.parse(sound.stem) and files.companion(sound, endings) is None
    ]


def beat_speakers(takes: Iterable[Take]) -> tuple[str, ...]:
    """Return the speakers in the order of their numbers; those without one come last, by name."""
    numbers: dict[str, int] = {}
    for take in takes:
        name = BeatName.parse(take.name)
        number = name.number if name else 10**9
        numbers[take.speaker] = min(numbers.get(take.speaker, number), number)
    return tuple(sorted(numbers, key=lambda speaker: (numbers[speaker], speaker)))
