"""Pages of a study's contact sheet on which a segment's motion can be turned around, offline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from motion.files import digest
from motion.segment import Segment
from renderer.viewer.page import FILES, MAX_CLIPS, Scene, write_motion_page, write_shared_files
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder
from studyapp.study.media import StimulusVideo
from studyapp.study.settings.study import Study


@dataclass(frozen=True)
class MotionPages:
    """Pages of the motion of which there are rendered videos; they share avatar and viewer.

    Attributes
    ----------
    videos : mapping of (segment, condition) to StimulusVideo
        The study's videos.
    """

    folder: StudyFolder
    study: Study
    videos: Mapping[tuple[str, str], StimulusVideo]

    @cached_property
    def _viewer(self) -> str:
        """What tells pages of another viewer, or avatar, from those of this one."""
        avatar = self.study.video.avatar
        return digest(avatar, *(each for each in sorted(FILES.iterdir()) if each.is_file()))

    def write(self, place: Path, segment: Segment, conditions: Sequence[str]) -> Path | None:
        """Write a segment's page where it is not kept; None where it has no motion."""
        rendered = {
            name: self.videos[segment.name, name].rendered
            for name in conditions
            if (segment.name, name) in self.videos and not self.study.is_finished(name)
        }
        if not rendered:
            return None
        called = self.study.display_names
        labels = [called[name] for name in rendered]
        page = place / f"{digest(self._viewer, segment, labels, list(rendered.values()))}.html"
        if page.exists():
            return page
        scenes = self._scenes(segment, list(rendered))
        if not scenes:
            return None
        look = study_look(self.folder, self.study)
        write_shared_files(place, look)
        write_motion_page(page, f"Motion for {segment.name}", scenes, look, shares=True)
        return page

    def _scenes(self, segment: Segment, conditions: Sequence[str]) -> list[Scene]:
        """Return as many scenes as the conditions need, in their order."""
        called, scenes = self.study.display_names, []
        for first in range(0, len(conditions), MAX_CLIPS):
            names = conditions[first : first + MAX_CLIPS]
            scene, _ = segment_scene(self.folder, self.study, segment, names, heard=segment)
            clips = {called[name]: clip for name, clip in scene.clips.items()}
            if clips:
                scenes.append(replace(scene, name=", ".join(clips), clips=clips))
        return scenes
