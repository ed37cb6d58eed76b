"""A study as it is served: its definition and every video a participant may be shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from motion.errors import InputError
from motion.segment import Segment
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import read_stimuli
from studyapp.definition.study import Study

PairKey = tuple[str, str, str]
"""Segment, condition under A, condition under B."""


@dataclass(frozen=True, kw_only=True)
class ServedVideo:
    """One composed pair: its file, and its length in seconds."""

    file: Path
    duration: float


@dataclass(frozen=True, kw_only=True)
class ServedStudy:
    """A study whose media are complete."""

    study: Study
    segments: tuple[Segment, ...]
    videos: Mapping[PairKey, ServedVideo]

    @classmethod
    def read(cls, root: Path) -> Self:
        """Read the study in folder `root`.

        Raises
        ------
        InputError
            If its definition, segments or stimuli are unusable, or a video that a participant
            may be shown is missing; the message names the file.
        """
        folder = StudyFolder(root)
        study = folder.study()
        segments = tuple(folder.segments())
        stimuli = read_stimuli(folder.stimuli)
        files: dict[PairKey, ServedVideo] = {
            (pair.segment, pair.left, pair.right): ServedVideo(
                file=(root / pair.file).resolve(), duration=pair.duration
            )
            for pair in stimuli.pairs
        }
        videos: dict[PairKey, ServedVideo] = {}
        for segment in segments:
            for left, right in study.pairs:
                key = (segment.name, left, right)
                if key not in files:
                    raise InputError(
                        f"there is no video of {left!r} beside {right!r} for segment "
                        f"{segment.name}",
                        where=folder.stimuli,
                        remedy="Run 'motionjury render'",
                    )
                if not files[key].file.is_file():
                    raise InputError(
                        "the video is missing",
                        where=files[key].file,
                        remedy="Run 'motionjury render' again",
                    )
                videos[key] = files[key]
        return cls(study=study, segments=segments, videos=videos)

    def video(self, segment: str, left: str, right: str) -> ServedVideo | None:
        """Return the video of a pair, None where the study no longer has it."""
        return self.videos.get((segment, left, right))
