"""What the checks look at: a study's file, segments and videos, read once."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Final, Self

from motion.segment import Segment
from studyapp.study.design.trial import Arm, Content, PlannedTrial
from studyapp.study.finished_videos import finished_video_path
from studyapp.study.folder import StudyFolder
from studyapp.study.media import Media, VideoFile
from studyapp.study.settings.study import Study

MOST_PLACES: Final = 240
"""Places of an arm whose trials are planned; of more, as many of the first ones."""


@dataclass(frozen=True, kw_only=True)
class Material:
    """One study before its launch.

    Attributes
    ----------
    media : Media or None
        None where nothing was rendered or copied yet.
    """

    folder: StudyFolder
    study: Study
    segments: tuple[Segment, ...]
    media: Media | None

    @classmethod
    def of(cls, folder: StudyFolder, study: Study) -> Self:
        """Read what `study` in `folder` has.

        Raises
        ------
        InputError
            If the segments, or the list of videos, cannot be read.
        """
        return cls(
            folder=folder,
            study=study,
            segments=tuple(folder.segments_of(study)),
            media=Media.of(folder, study) if folder.stimuli.exists() else None,
        )

    @cached_property
    def by_name(self) -> Mapping[str, Segment]:
        """The segments under their names."""
        return MappingProxyType({segment.name: segment for segment in self.segments})

    @cached_property
    def contents(self) -> tuple[Content, ...]:
        """What participants may be shown, segment after segment."""
        order = {name: place for place, name in enumerate(self.by_name)}
        shown = self.study.contents(self.segments)
        return tuple(sorted(shown, key=lambda content: order[content[0].segment]))

    @cached_property
    def shown(self) -> Mapping[Content, VideoFile]:
        """The videos that are there, under what they show."""
        if self.media is None:
            return MappingProxyType({})
        found = {content: self.media.find(content) for content in self.contents}
        return MappingProxyType(
            {content: video for content, video in found.items() if video and video.file.is_file()}
        )

    @cached_property
    def brought(self) -> Mapping[Path, Content]:
        """The finished videos that must be brought, and what each shows."""
        files: dict[Path, Content] = {}
        for content in self.contents:
            if len(content) == 1 and self.study.is_finished(content[0].condition):
                files.setdefault(finished_video_path(self.folder.videos, content[0]), content)
        return MappingProxyType(files)

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

    def name_of(self, file: Path) -> str:
        """Return a file's path as it is told: from the study's folder where it lies there."""
        root = self.folder.root
        return str(file.relative_to(root) if file.is_relative_to(root) else file)
