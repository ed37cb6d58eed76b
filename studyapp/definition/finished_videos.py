"""Finished videos from any other tool: ``videos/<condition>/<segment>.mp4``.

The same motion heard with another segment's speech lies beside it as
``<segment>@<speech>.mp4``; no segment's name holds an @. Participants are shown copies: the files
that were brought stay as they are.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import av

from motion.errors import InputError
from motion.segment import EMOTIONS, Segment
from studyapp.definition.study import Study
from studyapp.design.stimulus import Content, Stimulus


def shows_copy(study: Study, content: Content) -> bool:
    """Tell whether participants are shown a copy of the video of `content`.

    They are of all single videos where some were brought finished, since these differ in what
    their files tell, and of every one without sound.
    """
    (first, *others) = content
    finished = any(map(study.is_finished, (*study.conditions, study.catch.condition)))
    return not others and (finished or first.speech is None)


def finished_video(videos: Path, stimulus: Stimulus) -> Path:
    """Return where the finished video of `stimulus` lies in the folder `videos`.

    A stimulus without sound is the video with its own speech, copied without it.
    """
    other = stimulus.speech not in (None, stimulus.segment)
    name = f"{stimulus.segment}@{stimulus.speech}" if other else stimulus.segment
    return videos / stimulus.condition / f"{name}.mp4"


def seconds_of(video: Path) -> float:
    """Return how long a video lasts.

    Raises
    ------
    InputError
        If it cannot be opened.
    """
    try:
        with av.open(str(video)) as container:
            return (container.duration or 0) / av.time_base
    except (av.FFmpegError, OSError):
        raise InputError(
            "this is no video that can be played",
            where=video,
            remedy="Bring it as H.264 and AAC in MP4",
        ) from None


def finished_segments(videos: Path, conditions: Sequence[str]) -> tuple[Segment, ...]:
    """Return the segments that every one of `conditions` has a finished video of.

    For studies without speech files: nothing is known of a speaker or an emotion.
    """
    names = [
        {path.stem for path in (videos / condition).glob("*.mp4") if "@" not in path.stem}
        for condition in conditions
    ]
    return tuple(
        Segment(
            name=name,
            wav="",
            start=0.0,
            end=seconds_of(videos / conditions[0] / f"{name}.mp4"),
            speaker="",
            emotion=EMOTIONS[0],
        )
        for name in sorted(set.intersection(*names))
    )
