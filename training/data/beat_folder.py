"""BEAT and BEAT2 (Liu et al. 2022, 2024), and any folder of SMPL-X ``.npz`` files and sound."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path

from motion.errors import InputError
from training.data.beat_names import BeatName
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
    without_doubles,
)
from training.data.take import Take


def find_beat(files: FolderFiles) -> Findings:
    """Return the takes of a folder that holds BEAT's recordings, in folders or flat.

    Every ``.bvh`` is a take; sound (``.wav``), facial weights (``.json``) and annotated gestures
    (``.txt``) have its name. The last two may be missing.
    """
    return _found(files, ".bvh", _beat_take)


def find_beat2(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SMPL-X motion and sound.

    Every ``.npz`` with poses is a take; its sound has the same name, beside it or in another
    folder, as BEAT2 keeps motion in ``smplxflame_30``, sound in ``wave16k`` and annotated gestures
    in ``sem``. Names tell speaker and emotion where they are BEAT's; else the folder that holds
    motion and sound is the speaker's.
    """
    return _found(files, ".npz", _beat2_take)


def _found(
    files: FolderFiles, ending: str, take_of: Callable[[FolderFiles, Path], FoundTake | None]
) -> Findings:
    found, skipped = each_take(files.ending_in(ending), partial(take_of, files))
    takes, doubles = without_doubles(found)
    return Findings(
        takes=takes,
        skipped=(*skipped, *_lonely_sounds(files, ending), *doubles),
        speakers=_speakers(one.take for one in takes),
        split_rule="the rule published with BEAT",
    )


def _beat_take(files: FolderFiles, motion: Path) -> FoundTake:
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
    return _placed(take, files, name)


def _beat2_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if not has_arrays(motion, "poses"):
        if files.companion(motion, SOUND_ENDINGS):
            raise InputError(
                "the file holds no poses", where=motion, remedy="Give SMPL-X poses in it"
            )
        return None
    speech = sound_of(motion, files)
    place, _ = split_folder(files.place_of(motion))
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
    return _placed(take, files, name)


def _placed(take: Take, files: FolderFiles, name: BeatName | None) -> FoundTake:
    place, folder_split = split_folder(files.place_of(take.motion).with_suffix(""))
    return FoundTake(
        take=take,
        place=place.as_posix(),
        recording=take.motion.stem,
        given_split=folder_split or (name.published_split if name else None),
    )


def _lonely_sounds(files: FolderFiles, ending: str) -> list[InputError]:
    """Return what to say of sound that BEAT would name so, and that has no motion."""
    return [
        InputError(
            "the sound has no motion", where=sound, remedy=f"Put {sound.stem}{ending} beside it"
        )
        for sound in files.ending_in(".wav")
        if BeatName.parse(sound.stem) and files.companion(sound, (ending,)) is None
    ]


def _speakers(takes: Iterable[Take]) -> tuple[str, ...]:
    """Return the speakers in the order of their numbers; those without one come last, by name."""
    numbers: dict[str, int] = {}
    for take in takes:
        name = BeatName.parse(take.name)
        number = name.number if name else 10**9
        numbers[take.speaker] = min(numbers.get(take.speaker, number), number)
    return tuple(sorted(numbers, key=lambda speaker: (numbers[speaker], speaker)))
