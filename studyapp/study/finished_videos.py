"""Finished videos from any other tool: ``videos/<condition>/<segment>.mp4``.

The same motion heard with another segment's speech lies beside it as
``<segment>@<speech>.mp4``; no segment's name holds an @. Participants are shown copies: the files
that were brought stay as they are.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import Final

import av

from motion.audio import WHOLE_FORMATS
from motion.errors import InputError
from motion.segment import EMOTIONS, Segment, check_name
from studyapp.study.design.trial import Content, Stimulus
from studyapp.study.settings.study import Study

MIN_SIMILARITY: Final = 0.8
"""How alike two names must be (see `difflib`) for one to be taken for the other misspelt."""


def shows_copy(study: Study, content: Content) -> bool:
    """Tell whether participants are shown a copy of the video of `content`.

    They are of all single videos where some were brought finished, since these differ in what
    their files tell, and of every one without sound.
    """
    (first, *others) = content
    finished = any(map(study.is_finished, (*study.conditions, study.catch.condition)))
    return not others and (finished or first.speech is None)


def finished_video_path(videos: Path, stimulus: Stimulus) -> Path:
    """Return where the finished video of `stimulus` lies in the folder `videos`.

    A stimulus without sound is the video with its own speech, copied without it.
    """
    other = stimulus.speech not in (None, stimulus.segment)
    name = f"{stimulus.segment}@{stimulus.speech}" if other else stimulus.segment
    return videos / stimulus.condition / f"{name}.mp4"


def video_duration(video: Path) -> float:
    """Return how long a video lasts.

    Raises
    ------
    InputError
        If it cannot be opened.
    """
    try:
        with av.open(str(video), options=dict(WHOLE_FORMATS)) as container:
            return (container.duration or 0) / av.time_base
    except (av.FFmpegError, OSError):
        raise InputError(
            "this is not a video that can be played",
            where=video,
            remedy="Bring it as H.264 and AAC in MP4",
        ) from None


def finished_segments(
    videos: Path, conditions: Sequence[str], *, allow_gaps: bool = False
) -> tuple[Segment, ...]:
    """Return the segments that `conditions` have finished videos of.

    For studies without speech files: nothing is known of a speaker or an emotion.

    Parameters
    ----------
    allow_gaps : bool
        Whether a segment that one of the conditions lacks is left out. Otherwise it is a segment
        of the study, and `motionjury check` names the missing video.

    Raises
    ------
    InputError
        If there is no video, no segment is left, or a file's name is not a segment's.
    """
    brought = {
        condition: {
            path.stem: path
            for path in sorted((videos / condition).glob("*.mp4"))
            if "@" not in path.stem
        }
        for condition in conditions
    }
    owners: dict[str, list[str]] = {}
    for condition, files in brought.items():
        for name, path in files.items():
            owners.setdefault(check_name(name, "segment", path), []).append(condition)
    if allow_gaps:
        names = {name for name, having in owners.items() if len(having) == len(conditions)}
    else:
        names = set(owners) - _misspelt_names(owners, conditions[0])
    if not names:
        raise InputError(
            "no segment has a finished video of every condition"
            if owners
            else "there are no finished videos yet",
            where=videos,
            remedy="Bring them as "
            + ", ".join(f"{condition}/<segment>.mp4" for condition in conditions)
            + ", with the same names in each folder",
        )
    return tuple(
        Segment(
            name=name,
            wav="",
            start=0.0,
            end=video_duration(brought[owners[name][0]][name]),
            speaker="",
            emotion=EMOTIONS[0],
        )
        for name in sorted(names)
    )


def similar_file(file: Path, needed: Collection[Path]) -> Path | None:
    """Return the file that may be the missing `file` under a misspelt name.

    Parameters
    ----------
    needed : collection of Path
        Files that are what their names say.
    """
    spare = {
        path.name.casefold(): path
        for path in sorted(file.parent.glob("*"))
        if path.is_file() and path not in needed
    }
    found = get_close_matches(file.name.casefold(), spare, n=1, cutoff=MIN_SIMILARITY)
    return spare[found[0]] if found else None


def _misspelt_names(owners: Mapping[str, Sequence[str]], first: str) -> set[str]:
    """Return the names that are another one misspelt: alike, and no condition has both.

    Of two such names, the one that more conditions have is right; of two that as many have, the
    one of the condition `first`.
    """
    found: set[str] = set()
    right: list[str] = []
    for name in sorted(
        owners, key=lambda name: (-len(owners[name]), first not in owners[name], name)
    ):
        apart = [other for other in right if not set(owners[other]) & set(owners[name])]
        alike = get_close_matches(
            name.casefold(), map(str.casefold, apart), n=1, cutoff=MIN_SIMILARITY
        )
        if alike:
            found.add(name)
        else:
            right.append(name)
    return found
