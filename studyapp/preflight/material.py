"""The input of all checks: a study's settings, segments and videos, read once."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Final, Self

from motion.segment import Segment
from studyapp.study.design.trial import Arm, Content, PlannedTrial
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media, VideoFile, finished_video_path
from studyapp.study.settings.study import Study

MOST_PLACES: Final = 240
"""Places of an arm whose trials are planned; of larger arms, the first ones."""


@dataclass(frozen=True, kw_only=True)
class Material:
    """One study before its launch.

    Attributes
    ----------
    media : Media or None
        None before anything is rendered or copied.
    """

    folder: StudyFolder
    study: Study
    segments: tuple[Segment, ...]
    media: Media | None

    @classmethod
    def read(cls, folder: StudyFolder, study: Study) -> Self:
        """Read the segments and the list of videos of `study` in `folder`.

        Raises
        ------
        InputError
            If either cannot be read.
        """
        return cls(
            folder=folder,
            study=study,
            segments=folder.segments_of(study),
            media=Media.of(folder, study) if folder.stimuli.exists() else None,
        )

    @cached_property
    def segments_by_name(self) -> Mapping[str, Segment]:
        """The segments by name."""
        return {segment.name: segment for segment in self.segments}

    @cached_property
    def contents(self) -> tuple[Content, ...]:
        """All that participants may be shown, in the order of segments."""
        order = list(self.segments_by_name)
        contents = self.study.contents(self.segments)
        return tuple(sorted(contents, key=lambda content: order.index(content[0].segment)))

    @cached_property
    def shown(self) -> Mapping[Content, VideoFile]:
        """The videos that exist, by content."""
        if self.media is None:
            return {}
        videos = {content: self.media.find(content) for content in self.contents}
        return {
            content: video for content, video in videos.items() if video and video.file.is_file()
        }

    @cached_property
    def finished(self) -> Mapping[Path, Content]:
        """The content of each finished video that the researcher supplies."""
        files: dict[Path, Content] = {}
        for content in self.contents:
            if len(content) == 1 and self.study.is_finished(content[0].condition):
                files.setdefault(finished_video_path(self.folder.videos, content[0]), content)
        return files

    @cached_property
    def planned(self) -> tuple[tuple[Arm, tuple[tuple[PlannedTrial, ...], ...]], ...]:
        """Each arm with the trials of its places, at most `MOST_PLACES` of them."""
        return tuple(
            (
                arm,
                tuple(
                    self.study.plan(arm, number, self.segments)
                    for number in range(min(arm.places, MOST_PLACES))
                ),
            )
            for arm in self.study.arms
        )

    @property
    def plans(self) -> Iterator[tuple[PlannedTrial, ...]]:
        """The trials of all planned places, arm after arm."""
        return (plan for _, plans in self.planned for plan in plans)

    def display_path(self, file: Path) -> str:
        """Return a file's path, relative to the study folder if it lies there."""
        root = self.folder.root
        return str(file.relative_to(root) if file.is_relative_to(root) else file)
