"""BEAT and BEAT2 (Liu et al. 2022, 2024), and any folder of SMPL-X ``.npz`` files and sound.

The name of a recording is ``{number}_{name}_{type}_{start}_{end}``: number and name of the speaker,
the type of recording (even: monologue; odd: conversation; 0 and 1: English), and the first and last
text that is spoken.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final, Self

from motion.audio import read_audio
from motion.endings import SPEECH_ENDINGS
from motion.errors import InputError
from motion.formats.bvh import BvhFrameCountError, read_bvh
from motion.formats.bvh_motion import BvhMotion, settle_first_frame
from motion.segment import EMOTIONS
from training.data.found_take import (
    UNKNOWN_SPEAKER,
    Findings,
    FolderFiles,
    FoundTake,
    each_take,
    found_take,
    has_arrays,
    sound_of,
    split_folder,
    without_duplicates,
)
from training.data.take import LONGEST_DIFFERENCE, Split, Take


def read_beat_bvh(take: Take) -> BvhMotion:
    """Return the motion of a take, without a leftover calibration pose in its first row.

    If the header declares another number of frames than the file has, as in downsampled files, the
    frame rate is the header's or the one that keeps the header's duration, whichever matches the
    sound.

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
"""The last text of a monologue in each of `motion.segment.EMOTIONS`."""

_FOUR_HOUR_SPEAKERS: Final = frozenset({1, 2, 3, 4, 6, 7, 8, 9, 11, 21})
"""Speakers with four hours of recordings; the other twenty have one."""

_SPEAKERS: Final = 30
_FIRST_OF_EMOTION: Final = frozenset(last + 1 for last in LAST_TEXTS[:-1])
_LAST_OF_EMOTION: Final = frozenset(LAST_TEXTS[1:])


@dataclass(frozen=True, kw_only=True)
class BeatName:
    """The parts of a recording's name.

    Attributes
    ----------
    number : int
        Number of the speaker, from 1.
    speaker : str
        Name of the speaker.
    recording_type : int
        Type of the recording, 0 to 7; see the module.
    start, end : int
        Numbers of the first and last text.
    """

    number: int
    speaker: str
    recording_type: int
    start: int
    end: int

    @classmethod
    def parse(cls, name: str) -> Self | None:
        """Return the parts of `name`; None if it is not a name of BEAT."""
        match = _NAME.fullmatch(name)
        if match is None:
            return None
        return cls(
            number=int(match["number"]),
            speaker=match["speaker"],
            recording_type=int(match["type"]),
            start=int(match["start"]),
            end=int(match["end"]),
        )

    @property
    def emotion(self) -> str:
        """The emotion of a monologue; empty for conversations and for several emotions."""
        if self.recording_type % 2:
            return ""
        first, last = (_emotion_of(text) for text in (self.start, self.end))
        return first if first == last else ""

    @property
    def published_split(self) -> Split | None:
        """The split of an English recording of a single text, by the rule published with BEAT.

        For the twenty speakers with one hour, the rule cuts some recordings into a validation half
        and a test half. Here the whole recording is for testing, so that no recording is in two
        splits. None for recordings that the rule does not cover.
        """
        if self.recording_type > 1 or self.start != self.end or not 1 <= self.number <= _SPEAKERS:
            return None
        four_hours = self.number in _FOUR_HOUR_SPEAKERS
        if self.recording_type == 1:
            if self.start == 1:
                return "test"
            return "validation" if four_hours and self.start == 12 else "train"
        if not 1 <= self.start <= LAST_TEXTS[-1]:
            return None
        if self.start <= 8:
            return "test" if four_hours or self.start <= 4 else "validation"
        if self.start in _FIRST_OF_EMOTION:
            return "test"
        if four_hours and (57 <= self.start <= 64 or self.start in _LAST_OF_EMOTION):
            return "validation"
        return "train"


def _emotion_of(text: int) -> str:
    last_texts = zip(LAST_TEXTS, EMOTIONS, strict=True)
    return next((emotion for last_text, emotion in last_texts if text <= last_text), "")


def find_beat(files: FolderFiles) -> Findings:
    """Return the takes of a folder of BEAT, nested or flat.

    Every ``.bvh`` is a take. Its sound (``.wav``), facial weights (``.json``) and annotated
    gestures (``.txt``) share its name; the last two may be missing.
    """
    return _find_takes(files, ".bvh", _beat_take)


def find_beat2(files: FolderFiles) -> Findings:
    """Return the takes of a folder of SMPL-X motion and sound.

    Every ``.npz`` with poses is a take. Its sound has the same name, in the same or another folder:
    BEAT2 keeps motion in ``smplxflame_30``, sound in ``wave16k`` and annotated gestures in ``sem``.
    BEAT's names give speaker and emotion; otherwise the folder of motion and sound names the
    speaker.
    """
    return _find_takes(files, ".npz", _beat2_take)


def _find_takes(
    files: FolderFiles, ending: str, take_of: Callable[[FolderFiles, Path], FoundTake | None]
) -> Findings:
    candidates, skipped = each_take(files.ending_in(ending), partial(take_of, files))
    takes, duplicates = without_duplicates(candidates)
    return Findings(
        takes=takes,
        skipped=(*skipped, *_unpaired_sounds(files, ending), *duplicates),
        speakers=_speakers(candidate.take for candidate in takes),
        split_rule="the rule published with BEAT",
    )


def _beat_take(files: FolderFiles, motion: Path) -> FoundTake:
    name = BeatName.parse(motion.stem)
    if name is None:
        raise InputError(
            "the file's name is not in BEAT's format",
            where=motion,
            remedy="Name it {number}_{name}_{type}_{start}_{end}, such as 2_scott_0_9_9",
        )
    face = files.companion(motion, (".json",))
    return _named_take(files, motion, name, name.speaker, face=face)


def _beat2_take(files: FolderFiles, motion: Path) -> FoundTake | None:
    if not has_arrays(motion, "poses"):
        if files.companion(motion, SPEECH_ENDINGS):
            raise InputError(
                "the file holds no poses", where=motion, remedy="Give SMPL-X poses in it"
            )
        return None
    speech = sound_of(motion, files)
    place, _ = split_folder(files.place_of(motion))
    name = BeatName.parse(motion.stem)
    in_speaker_folder = speech.parent == motion.parent and len(place.parts) > 1
    speaker = name.speaker if name else place.parts[-2] if in_speaker_folder else UNKNOWN_SPEAKER
    return _named_take(files, motion, name, speaker)


def _named_take(
    files: FolderFiles, motion: Path, name: BeatName | None, speaker: str, **tracks: Path | None
) -> FoundTake:
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    return found_take(
        files,
        motion,
        place,
        name=motion.stem,
        speaker=speaker,
        emotion=name.emotion if name else "",
        recording=motion.stem,
        given_split=folder_split or (name.published_split if name else None),
        semantic=files.companion(motion, (".txt",)),
        **tracks,
    )


def _unpaired_sounds(files: FolderFiles, ending: str) -> list[InputError]:
    """Return an error for each sound with a BEAT name and no motion."""
    return [
        InputError(
            "the sound has no motion", where=sound, remedy=f"Put {sound.stem}{ending} next to it"
        )
        for sound in files.ending_in(".wav")
        if BeatName.parse(sound.stem) and files.companion(sound, (ending,)) is None
    ]


def _speakers(takes: Iterable[Take]) -> tuple[str, ...]:
    """Return the speakers by number; those without a number come last, by name."""
    numbers: dict[str, int] = {}
    for take in takes:
        name = BeatName.parse(take.name)
        number = name.number if name else 10**9
        numbers[take.speaker] = min(numbers.get(take.speaker, number), number)
    return tuple(sorted(numbers, key=lambda speaker: (numbers[speaker], speaker)))
