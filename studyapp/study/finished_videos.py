"""Finished videos from other tools: ``videos/<condition>/<segment>.mp4``.

The same motion with another segment's speech is ``<segment>@<speech>.mp4`` beside it; segment names
contain no @. Participants see copies, so the original files stay untouched.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
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
"""Similarity (see `difflib`) from which one name counts as a misspelling of another."""


def shows_copy(study: Study, content: Content) -> bool:
    """Tell whether participants see a copy of the video of `content`.

    They do for every video without sound, and for every single video of a study that has finished
    ones: their files would give the condition away.
    """
    (first, *others) = content
    finished = any(map(study.is_finished, (*study.conditions, study.catch.condition)))
    return not others and (finished or first.speech is None)


def finished_video_path(videos: Path, stimulus: Stimulus) -> Path:
    """Return the path of the finished video of `stimulus` in the folder `videos`.

    A stimulus without sound is copied from the video with its own speech.
    """
    is_mismatched = stimulus.speech not in (None, stimulus.segment)
    name = f"{stimulus.segment}@{stimulus.speech}" if is_mismatched else stimulus.segment
    return videos / stimulus.condition / f"{name}.mp4"


def video_duration(video: Path) -> float:
    """Return the duration of a video in seconds; `InputError` if it cannot be opened."""
    try:
        with av.open(str(video), options=dict(WHOLE_FORMATS)) as container:
            return (container.duration or 0) / av.time_base
    except (av.FFmpegError, OSError):
        raise InputError(
            "this is not a playable video",
            where=video,
            remedy="Provide an MP4 file with H.264 video and AAC audio",
        ) from None


def finished_segments(
    videos: Path, conditions: Sequence[str], *, allow_gaps: bool = False
) -> tuple[Segment, ...]:
    """Return the segments named by the finished videos of `conditions`.

    For studies without speech files: speaker and emotion are unknown.

    Parameters
    ----------
    allow_gaps : bool
        Whether to leave out segments that a condition lacks. Otherwise they stay in the study,
        and `motionjury check` names the missing videos.

    Raises
    ------
    InputError
        If there is no video, no segment is left, a file name is not a valid segment name, or no
        video of a segment can be opened.
    """
    videos_of = {
        condition: {
            path.stem: path
            for path in sorted((videos / condition).glob("*.mp4"))
            if "@" not in path.stem
        }
        for condition in conditions
    }
    owners: dict[str, list[str]] = {}
    for condition, files in videos_of.items():
        for name, path in files.items():
            owners.setdefault(check_name(name, "segment", path), []).append(condition)
    if allow_gaps:
        names = {name for name, owning in owners.items() if len(owning) == len(conditions)}
    else:
        names = set(owners) - _misspelt_names(owners, conditions[0])
    if not names:
        paths = ", ".join(f"{condition}/<segment>.mp4" for condition in conditions)
        raise InputError(
            "no segment has a finished video of every condition"
            if owners
            else "there are no finished videos yet",
            where=videos,
            remedy=f"Save them as {paths}, with the same names in each folder",
        )
    return tuple(
        Segment(
            name=name,
            wav="",
            start=0.0,
            end=_duration_of_any([videos_of[condition][name] for condition in owners[name]]),
            speaker="",
            emotion=EMOTIONS[0],
        )
        for name in sorted(names)
    )


def _duration_of_any(videos: Sequence[Path]) -> float:
    """Return the duration of the first video that can be opened; `check` names the others."""
    for video in videos[:-1]:
        with suppress(InputError):
            return video_duration(video)
    return video_duration(videos[-1])


def similar_file(file: Path, needed: Collection[Path]) -> Path | None:
    """Return the file that may be the missing `file` under a misspelt name.

    Parameters
    ----------
    needed : collection of Path
        Files that the study needs under their own names.
    """
    unneeded = {
        path.name.casefold(): path
        for path in sorted(file.parent.glob("*"))
        if path.is_file() and path not in needed
    }
    matches = get_close_matches(file.name.casefold(), unneeded, n=1, cutoff=MIN_SIMILARITY)
    return unneeded[matches[0]] if matches else None


def _misspelt_names(owners: Mapping[str, Sequence[str]], first: str) -> set[str]:
    """Return the names that misspell another one: they are similar, and no condition has both.

    The name that more conditions have is right; on a tie, that of the condition `first`.
    """
    misspelt: set[str] = set()
    correct: list[str] = []
    for name in sorted(
        owners, key=lambda name: (-len(owners[name]), first not in owners[name], name)
    ):
        candidates = [
            other.casefold() for other in correct if not set(owners[other]) & set(owners[name])
        ]
        if get_close_matches(name.casefold(), candidates, n=1, cutoff=MIN_SIMILARITY):
            misspelt.add(name)
        else:
            correct.append(name)
    return misspelt
