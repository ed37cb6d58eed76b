"""Which file shows participants what: rendered videos, and copies of others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from studyapp.study.design.stimulus import Content, Stimulus
from studyapp.study.finished_videos import shows_copy
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.stimuli import Stimuli, VideoCopy, read_stimuli


@dataclass(frozen=True, kw_only=True)
class VideoFile:
    """A video's file.

    Attributes
    ----------
    duration : float
        Seconds.
    made_from : str
        Digest of all that its picture and sound depend on. It stays where the file is made again
        from the same, or is only padded or copied anew.
    """

    file: Path
    duration: float
    made_from: str


@dataclass(frozen=True, kw_only=True)
class Media:
    """All videos that a study's participants are shown.

    Attributes
    ----------
    study : Study
        Tells of which videos copies are shown.
    made : mapping of Content to VideoFile
        What `motionjury render` has rendered.
    copies : mapping of Content to VideoFile
        What it has copied.
    """

    study: Study
    made: Mapping[Content, VideoFile]
    copies: Mapping[Content, VideoFile]

    @classmethod
    def of(cls, folder: StudyFolder, study: Study) -> Self:
        """Read what the study in `folder` has.

        Raises
        ------
        InputError
            If nothing was rendered yet.
        """
        stimuli = read_stimuli(folder.stimuli)
        return cls(
            study=study,
            made=_rendered(folder, stimuli),
            copies={
                (stimulus_of(copy),): VideoFile(
                    file=folder.root / copy.file, duration=copy.duration, made_from=copy.original
                )
                for copy in stimuli.copies
            },
        )

    def find(self, content: Content) -> VideoFile | None:
        """Return the video that shows `content`, whether or not its file is there; else None."""
        made = self.copies if shows_copy(self.study, content) else self.made
        return made.get(content)


def stimulus_of(copy: VideoCopy) -> Stimulus:
    """Return what a copy shows."""
    return Stimulus(condition=copy.condition, segment=copy.segment, speech=copy.heard)


def _rendered(folder: StudyFolder, stimuli: Stimuli) -> dict[Content, VideoFile]:
    clips: dict[Content, VideoFile] = {
        (
            Stimulus(
                condition=clip.condition,
                segment=clip.segment,
                speech=clip.speech or clip.segment,
            ),
        ): VideoFile(file=folder.root / clip.file, duration=clip.duration, made_from=clip.key)
        for clip in stimuli.clips
    }
    pairs: dict[Content, VideoFile] = {
        tuple(Stimulus.own(side, pair.segment) for side in (pair.left, pair.right)): VideoFile(
            file=folder.root / pair.file, duration=pair.duration, made_from=pair.key
        )
        for pair in stimuli.pairs
    }
    return clips | pairs
