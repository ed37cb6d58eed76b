"""Which file shows what: rendered videos and finished ones alike."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from studyapp.definition.finished_videos import finished_video, seconds_of
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import Stimuli, read_stimuli
from studyapp.definition.study import Study
from studyapp.design.stimulus import Content, Stimulus


@dataclass(frozen=True, kw_only=True)
class VideoFile:
    """A video's file, and its length in seconds."""

    file: Path
    duration: float


@dataclass(frozen=True, kw_only=True)
class Media:
    """All videos of a study.

    Attributes
    ----------
    folder : StudyFolder
        Where they lie.
    study : Study
        Tells which conditions have finished videos.
    rendered : mapping of Content to VideoFile
        What `motionjury render` has made.
    """

    folder: StudyFolder
    study: Study
    rendered: Mapping[Content, VideoFile]

    @classmethod
    def of(cls, folder: StudyFolder, study: Study) -> Self:
        """Read what the study in `folder` has.

        Raises
        ------
        InputError
            If something must have been rendered and nothing was.
        """
        stimuli = Stimuli() if study.only_finished else read_stimuli(folder.stimuli)
        return cls(folder=folder, study=study, rendered=_rendered(folder, stimuli))

    def find(self, content: Content) -> VideoFile | None:
        """Return the video that shows `content`, whether or not its file is there; else None."""
        (first, *others) = content
        if not others and self.study.is_finished(first.condition):
            path = finished_video(self.folder.videos, first)
            # What is not there is named by whoever looks for the file.
            seconds = seconds_of(path) if path.is_file() else 0.0
            return VideoFile(file=path, duration=seconds)
        return self.rendered.get(tuple(_heard(stimulus) for stimulus in content))


def _heard(stimulus: Stimulus) -> Stimulus:
    """Return what a muted stimulus is before the page mutes it."""
    if stimulus.speech is not None:
        return stimulus
    return Stimulus.own(stimulus.condition, stimulus.segment)


def _rendered(folder: StudyFolder, stimuli: Stimuli) -> dict[Content, VideoFile]:
    clips: dict[Content, VideoFile] = {
        (
            Stimulus(
                condition=clip.condition,
                segment=clip.segment,
                speech=clip.speech or clip.segment,
            ),
        ): VideoFile(file=folder.root / clip.file, duration=clip.duration)
        for clip in stimuli.clips
    }
    pairs: dict[Content, VideoFile] = {
        tuple(Stimulus.own(side, pair.segment) for side in (pair.left, pair.right)): VideoFile(
            file=folder.root / pair.file, duration=pair.duration
        )
        for pair in stimuli.pairs
    }
    return clips | pairs
