"""The videos that participants see of a study's clips, rendered or brought."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from studyapp.stimuli.digest import digest
from studyapp.study.design.stimulus import Stimulus
from studyapp.study.finished_videos import finished_video
from studyapp.study.folder import StudyFolder
from studyapp.study.settings.study import Study
from studyapp.study.stimuli import read_stimuli


@dataclass(frozen=True)
class ShownVideo:
    """A video, rendered or brought.

    Attributes
    ----------
    file : Path
        Where it is.
    rendered : str
        Digest of everything that a rendered one depends on; empty for one that was brought.
    """

    file: Path
    rendered: str = ""

    @property
    def key(self) -> str:
        """What tells it from every other video."""
        return self.rendered or digest(self.file)


def shown_videos(
    folder: StudyFolder, study: Study, shown: Iterable[tuple[str, str]]
) -> dict[tuple[str, str], ShownVideo]:
    """Return the videos that are there of each (segment, condition), with its own speech."""
    rendered = () if study.only_finished else read_stimuli(folder.stimuli).clips
    videos = {
        (clip.segment, clip.condition): ShownVideo(folder.root / clip.file, clip.key)
        for clip in rendered
        if clip.speech is None
    }
    for segment, condition in shown:
        if study.is_finished(condition):
            file = finished_video(folder.videos, Stimulus.own(condition, segment))
            if file.is_file():
                videos[segment, condition] = ShownVideo(file)
    return {key: video for key, video in videos.items() if video.file.is_file()}
