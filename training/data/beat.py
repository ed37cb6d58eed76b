"""BEAT and BEAT2 (Liu et al. 2022, 2024), and any folder of SMPL-X ``.npz`` files and sound.

The name of a recording is ``{number}_{name}_{type}_{start}_{end}``: number and name of the speaker,
the type of recording (even: somebody speaks alone; odd: conversation; 0 and 1: English), and the
first and last of the texts that are spoken.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final, Self

from motion.audio import read_audio
from motion.errors import InputError
from motion.formats.bvh import BvhFrameCountError, read_bvh
from motion.formats.bvh_motion import BvhMotion, settle_first_frame
from motion.segment import EMOTIONS
from training.data.found_take import (
    SOUND_ENDINGS,
    UNKNOWN_SPEAKER,
    Findings,
    FolderFiles,
    FoundTake,
    each_take,
    has_arrays,
    sound_of,
    split_folder,
    transcript_of,
    usable_name,
    without_doubles,
)
from training.data.take import LONGEST_DIFFERENCE, Split, Take


def read_beat_bvh(take: Take) -> BvhMotion:
    """Return the motion of a take without what was left over in its first row.

    Where the header promises another number of frames than there are, as in files that were
    thinned out, the frame rate is the header's, or that at which the frames last as long as the
    header says, whichever makes them as long as the sound.

    Raises
    ------
    InputError
        If the file is not a BVH or is damaged, or neither frame rate fits the sound.
    """
    try:
        motion = read_bvh(take.motion)
    except BvhFrameCountError as error:
        seconds = read_audio(take.speech).duration
        fitting = [
            rate
            for rate in error.frame_rates
            if abs(error.rows / rate - seconds) <= LONGEST_DIFFERENCE
        ]
        if not fitting:
            raise InputError(
                f"{error.what}, while the sound lasts {seconds:.2f} s",
                where=take.motion,
                remedy="Copy the motion again, or correct its header",
            ) from error
        motion = read_bvh(take.motion, frame_rate=fitting[0])
    return settle_first_frame(motion)


_NAME: Final = re.compile(
    r"(?P<number>\d{1,4})_(?P<speaker>[A-Za-z][A-Za-z0-9-]*)_(?P<type>\d)_"
    r"(?P<start>\d{1,5})_(?P<end>\d{1,5})"
)

LAST_TEXTS: Final = (64, 72, 80, 86, 94, 102, 110, 118)
"""Up to which text somebody who speaks alone does so with each of `motion.segment.EMOTIONS`."""

_FOUR_HOURS: Final = frozenset({1, 2, 3, 4, 6, 7, 8, 9, 11, 21})
"""Speakers of whom there are four hours; of the other twenty there is one."""

_SPEAKERS: Final = 30
_FIRST_OF_EMOTION: Final = frozenset(last + 1 for last in LAST_TEXTS[:-1])
_LAST_OF_EMOTION: Final = frozenset(LAST_TEXTS[1:])


@dataclass(frozen=True, kw_only=True)
class BeatName:
    """What a name tells.

    Attributes
    ----------
    number : int
        Of the speaker, from 1.
    speaker : str
        Their name.
    recording_type : int
        0 to 7, see above.
    start, end : int
        First and last text.
    """

    number: int
    speaker: str
    recording_type: int
    start: int
    end: int

    @classmethod
    def parse(cls, name: str) -> Self | None:
        """Return what `name` tells; None where BEAT names nothing like that."""
        found = _NAME.fullmatch(name)
        if found is None:
            return None
        return cls(
            number=int(found["number"]),
            speaker=found["speaker"],
            recording_type=int(found["type"]),
            start=int(found["start"]),
            end=int(found["end"]),
        )

    @property
    def emotion(self) -> str:
        """The emotion of somebody who speaks alone; empty for conversations and other texts.

        Texts with several emotions have none either.
        """
        if self.recording_type % 2:
            return ""
        first, last = (_emotion_of(text) for text in (self.start, self.end))
        return first if first == last else ""

    @property
    def published_split(self) -> Split | None:
        """The split of an English recording of a single text, by the rule published with BEAT.

        Of the twenty speakers of one hour, the rule cuts recordings in two, half for validation
        and half for testing; here they are for testing as a whole, so that no recording is in two
        splits. None where the rule says nothing.
        """
        if self.recording_type > 1 or self.start != self.end or not 1 <= self.number <= _SPEAKERS:
            return None
        long = self.number in _FOUR_HOURS
        if self.recording_type == 1:
            if self.start == 1:
                return "test"
            return "validation" if long and self.start == 12 else "train"
        if not 1 <= self.start <= LAST_TEXTS[-1]:
            return None
        if self.start <= 8:
            return "test" if long or self.start <= 4 else "validation"
        if self.start in _FIRST_OF_EMOTION:
            return "test"
        if long and (57 <= self.start <= 64 or self.start in _LAST_OF_EMOTION):
            return "validation"
        return "train"


def _emotion_of(text: int) -> str:
    lasts = zip(LAST_TEXTS, EMOTIONS, strict=True)
    return next((emotion for last, emotion in lasts if text <= last), "")


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
