"""Finding the takes of a folder of any known layout.

Every motion file is a take. Its sound has the same name, in the same or another folder: BEAT2 keeps
motion in ``smplxflame_30``, sound in ``wave16k`` and annotated gestures in ``sem``. A folder
``train``, ``val`` or ``test`` above it names its split. BEAT's names give speaker and emotion;
otherwise a folder names the speaker. Clips as plain arrays are those of TED Gesture (Yoon et al.
2020), ``talk/clip.npz``, each of whose talks counts as one speaker, and SHOW (Yi et al. 2023),
``speaker/video/clip/clip.npy`` or ``speaker/video/clip.npy``. The data sets' own
pickles and databases of pickles are never opened, because unpickling them runs code.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Final

from motion.endings import SPEECH_ENDINGS
from motion.errors import InputError, listed
from motion.formats.ted_npz import ARRAYS as TED_ARRAYS
from motion.formats.transcript import preferred_transcript
from training.data.beat import BeatName
from training.data.found_take import (
    FolderFiles,
    FoundTake,
    has_arrays,
    list_folder,
    split_folder,
    usable_name,
)
from training.data.splitting import USUAL_NAMES, by_list, by_rule, read_split_list
from training.data.take import Kind, Take, TakeFolder

UNKNOWN_SPEAKER: Final = "unknown"
"""The speaker of takes whose data set names none."""

_SEE_DOCS: Final = "see docs/data.md, which also converts pickled data sets (.pkl, data.mdb)"


@dataclass(frozen=True)
class _Identity:
    """What the place of a motion file says about its take; see `FoundTake`."""

    place: PurePosixPath
    name: str
    speaker: str
    recording: str


def _beat_identity(place: PurePosixPath) -> _Identity:
    if BeatName.parse(place.name) is None:
        raise InputError(
            "the file's name is not in BEAT's format",
            remedy="Name it {number}_{name}_{type}_{start}_{end}, such as 2_scott_0_9_9",
        )
    return _beat2_identity(place)


def _beat2_identity(place: PurePosixPath) -> _Identity:
    return _Identity(place, place.name, place.parent.name or UNKNOWN_SPEAKER, place.name)


def _show_identity(place: PurePosixPath) -> _Identity:
    if place.name == place.parent.name:
        place = place.parent
    outer = place.parent.parts
    recording = place.parent if len(outer) > 1 else place
    speaker = outer[0] if outer else UNKNOWN_SPEAKER
    return _Identity(place, "_".join(place.parts), speaker, recording.as_posix())


def _ted_identity(place: PurePosixPath) -> _Identity:
    talk = place.parent if place.parent.parts else place
    speaker = place.parent.name or UNKNOWN_SPEAKER
    return _Identity(place, "_".join(place.parts), speaker, talk.as_posix())


@dataclass(frozen=True)
class _Layout:
    """Endings of motion files, arrays of which an ``.npz`` has one, and what places say."""

    endings: tuple[str, ...]
    arrays: tuple[str, ...]
    identity: Callable[[PurePosixPath], _Identity]
    split_rule: str = "the rule published with BEAT"


_FOLDERS: Final = "the folders train, val and test"
_LAYOUTS: Final[Mapping[Kind, _Layout]] = {
    "beat": _Layout((".bvh",), (), _beat_identity),
    "beat2": _Layout((".npz",), ("poses",), _beat2_identity),
    "show": _Layout((".npy",), (), _show_identity, _FOLDERS),
    "ted": _Layout((".npz",), TED_ARRAYS, _ted_identity, _FOLDERS),
}


def read_takes(folder: Path, *, split_list: Path | None = None) -> TakeFolder:
    """Find the takes in a folder of recordings; the files are read when features are computed.

    Parameters
    ----------
    folder : Path
        The data set as downloaded, or recordings in the same layout.
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
    layout = _kind_of(files)
    found, skipped = _find_takes(files, _LAYOUTS[layout])
    if not found:
        first = f"; the first file: {skipped[0]}" if skipped else ""
        raise InputError(
            f"the folder holds no take of {layout}{first}", where=folder, remedy=_SEE_DOCS
        )
    list_path = split_list or next(
        (folder / name for name in USUAL_NAMES if (folder / name).is_file()), None
    )
    if list_path:
        takes, notes = by_list(found, read_split_list(list_path), list_path)
    else:
        takes, notes = by_rule(found, _LAYOUTS[layout].split_rule)
    return TakeFolder(
        kind=layout,
        takes=tuple(sorted(takes, key=lambda take: take.name)),
        speakers=_speakers(takes),
        skipped=tuple(skipped),
        notes=notes,
    )


def _kind_of(files: FolderFiles) -> Kind:
    """Return the layout of the files."""
    if any(files.ending_in(".bvh")):
        return "beat"
    kinds = sorted(
        kind
        for kind, layout in _LAYOUTS.items()
        if any(
            files.companion(path, SPEECH_ENDINGS) and _is_motion(path, layout)
            for path in files.ending_in(*layout.endings)
        )
    )
    if len(kinds) == 1:
        return kinds[0]
    problem = f"may be {listed(kinds)}" if kinds else "holds no recordings of a known layout"
    raise InputError(
        f"the folder {problem}",
        where=files.root,
        remedy=f"Keep recordings of one layout in a folder: {_SEE_DOCS}",
    )


def _is_motion(path: Path, layout: _Layout) -> bool:
    return path.suffix.lower() != ".npz" or has_arrays(path, *layout.arrays)


def _find_takes(files: FolderFiles, layout: _Layout) -> tuple[list[FoundTake], list[InputError]]:
    """Return the takes, and why other files are not takes."""
    takes: dict[str, FoundTake] = {}
    skipped: list[InputError] = []
    for motion in files.ending_in(*layout.endings):
        sound = files.companion(motion, SPEECH_ENDINGS)
        is_motion = _is_motion(motion, layout)
        if sound is None and not is_motion:
            continue  # Data sets come with statistics and other arrays.
        try:
            if not is_motion:
                raise InputError(
                    f"the file is damaged, or holds none of the arrays {', '.join(layout.arrays)}",
                    remedy="Copy it again",
                )
            item = _found_take(files, motion, sound, layout)
            first = takes.setdefault(item.take.name, item)
            if first is not item:
                raise InputError(
                    f"take {item.take.name} exists twice; {first.take.motion} is used",
                    remedy="Rename or remove one of them",
                )
        except InputError as error:
            skipped.append(InputError(error.what, where=motion, remedy=error.remedy))
    skipped += [
        InputError(
            "the sound has no motion",
            where=sound,
            remedy=f"Put {sound.stem}{layout.endings[0]} next to it",
        )
        for sound in files.ending_in(*SPEECH_ENDINGS)
        if files.companion(sound, layout.endings) is None
    ]
    return [*takes.values()], skipped


def _found_take(files: FolderFiles, motion: Path, sound: Path | None, layout: _Layout) -> FoundTake:
    if sound is None:
        raise InputError("the motion has no sound", remedy=f"Put {motion.stem}.wav next to it")
    if not (motion.stat().st_size and sound.stat().st_size):
        raise InputError("the motion or its sound is empty", remedy="Copy both again")
    place, folder_split = split_folder(files.place_of(motion).with_suffix(""))
    identity = layout.identity(place)
    beat = BeatName.parse(motion.stem)
    take = Take(
        name=usable_name(identity.name),
        speaker=beat.speaker if beat else identity.speaker,
        emotion=beat.emotion if beat else "",
        split="train",
        speech=sound,
        motion=motion,
        face=files.companion(motion, (".json",)),
        semantic=files.companion(motion, (".txt",)),
        transcript=preferred_transcript(lambda ending: files.companion(motion, (ending,))),
    )
    return FoundTake(
        take=take,
        place=identity.place.as_posix(),
        recording=identity.recording,
        given_split=folder_split or (beat.published_split if beat else None),
    )


def _speakers(takes: Sequence[Take]) -> tuple[str, ...]:
    """Return the speakers by BEAT's number; those without a number come last, by name."""
    numbers: dict[str, int] = {}
    for take in takes:
        name = BeatName.parse(take.name)
        number = name.number if name else 10**9
        numbers[take.speaker] = min(numbers.get(take.speaker, number), number)
    return tuple(sorted(numbers, key=lambda speaker: (numbers[speaker], speaker)))
