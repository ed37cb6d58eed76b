"""The contact sheet of a study: all videos at a glance, and pages of their motion."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import digest, replacing, write_text
from motion.segment import Segment
from renderer.figures.sheet import (
    Sheet,
    SheetCell,
    draw_cell,
    glance_at,
    remarks_of,
    sheet_page,
)
from renderer.look import CELL_VERSION, Look
from renderer.viewer.page import FILES, MAX_CLIPS, Scene, write_motion_page, write_shared_files
from studyapp.stimuli.shown_motion import segment_scene, study_look
from studyapp.study.folder import StudyFolder
from studyapp.study.media import StimulusVideo, stimulus_videos
from studyapp.study.settings.study import Study

_NOT_SHOWN: Final = SheetCell(picture=None, remark="is not shown to participants", video="")


def write_contact_sheet(
    folder: StudyFolder,
    *,
    threads: int,
    on_done: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write the contact sheet of the study's videos, and return its HTML page.

    Cells of unchanged videos are kept.

    Parameters
    ----------
    folder : StudyFolder
        The study; a clip without a video gets an empty cell.
    threads : int
        Number of videos read at once.
    on_done : callable
        Called with (finished cells, all cells) after each.
    """
    study = folder.study()
    segments = folder.segments_of(study)
    shown = {(s.segment, s.condition) for content in study.contents(segments) for s in content}
    conditions = tuple(
        name
        for name in (*study.conditions, study.catch.condition)
        if name in {condition for _, condition in shown}
    )
    keys = [(segment.name, name) for segment in segments for name in conditions]
    videos = stimulus_videos(folder, study, shown)
    sheet_folder = folder.videos / "sheet"
    motion_pages = MotionPages(folder, study, videos)
    look = study_look(folder, study)
    steps = len(keys) + len(segments)

    def make_cell(key: tuple[str, str]) -> SheetCell:
        if key not in shown:
            return _NOT_SHOWN
        rendered_look = None if study.is_finished(key[1]) else look
        return _make_cell(sheet_folder, videos.get(key), rendered_look)

    cells: dict[tuple[str, str], SheetCell] = {}
    with ThreadPoolExecutor(threads) as pool:
        for number, (key, cell) in enumerate(
            zip(keys, pool.map(make_cell, keys), strict=True), start=1
        ):
            cells[key] = cell
            on_done(number, steps)
    motion: dict[str, str] = {}
    for number, segment in enumerate(segments, len(keys) + 1):
        motion_page = motion_pages.write(sheet_folder / "motion", segment, conditions)
        if motion_page is not None:
            motion[segment.name] = motion_page.relative_to(sheet_folder).as_posix()
        on_done(number, steps)
    labels = study.display_names
    sheet = Sheet(
        title=study.title,
        facts=f"{len(videos)} clips of {len(segments)} segments in {len(conditions)} conditions, "
        f"{look.size} pixels, {look.frame_rate} frames per second",
        conditions=tuple(labels[name] for name in conditions),
        roles={labels[name]: role for name, role in study.roles.items()},
        segments=segments,
        cells={(segment, labels[name]): cell for (segment, name), cell in cells.items()},
        motion=motion,
    )
    page = sheet_folder / "index.html"
    write_text(page, sheet_page(sheet))
    current = {_cell_file(sheet_folder, video) for video in videos.values()}
    current |= {sheet_folder / address for address in motion.values()}
    for pattern in (".cells/*.webp", "motion/*.html"):
        for path in sheet_folder.glob(pattern):
            if path not in current:
                path.unlink()
    return page


def _make_cell(sheet_folder: Path, video: StimulusVideo | None, look: Look | None) -> SheetCell:
    """Return the cell of a video, which is drawn unless it exists.

    `look` is None for finished videos, which were not rendered here.
    """
    if video is None:
        step = "add it" if look is None else "run 'motionjury render'"
        return SheetCell(picture=None, remark=f"there is no video: {step}", video="")
    file = _cell_file(sheet_folder, video)
    address = f"../../{video.file.relative_to(sheet_folder.parent.parent).as_posix()}"
    if file.exists():
        picture = file.read_bytes()
    else:
        try:
            picture = draw_cell(glance_at(video.file, look))
        except InputError as error:
            return SheetCell(picture=None, remark=error.what, video=address)
        with replacing(file) as draft:
            draft.write_bytes(picture)
    return SheetCell(picture=picture, remark="; ".join(remarks_of(picture)), video=address)


def _cell_file(sheet_folder: Path, video: StimulusVideo) -> Path:
    return sheet_folder / ".cells" / f"{digest(CELL_VERSION, video.key)}.webp"


@dataclass(frozen=True)
class MotionPages:
    """Offline pages of the rendered motion, which share avatar and viewer.

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
        """Digest of the viewer and the avatar."""
        files = [file for file in sorted(FILES.iterdir()) if file.is_file()]
        return digest(self.study.video.avatar, *files)

    def write(self, folder: Path, segment: Segment, conditions: Sequence[str]) -> Path | None:
        """Return a segment's page, which is written unless it exists; None without motion."""
        rendered = {
            name: self.videos[segment.name, name].rendered
            for name in conditions
            if (segment.name, name) in self.videos and not self.study.is_finished(name)
        }
        if not rendered:
            return None
        labels = [self.study.display_names[name] for name in rendered]
        page = folder / f"{digest(self._viewer, segment, labels, list(rendered.values()))}.html"
        if page.exists():
            return page
        scenes = self._scenes(segment, list(rendered))
        if not scenes:
            return None
        look = study_look(self.folder, self.study)
        write_shared_files(folder, look)
        write_motion_page(page, f"Motion for {segment.name}", scenes, look, shares=True)
        return page

    def _scenes(self, segment: Segment, conditions: Sequence[str]) -> list[Scene]:
        """Return the scenes of the conditions, `MAX_CLIPS` in each."""
        labels, scenes = self.study.display_names, []
        for first in range(0, len(conditions), MAX_CLIPS):
            names = conditions[first : first + MAX_CLIPS]
            scene, _ = segment_scene(self.folder, self.study, segment, names, speech=segment)
            clips = {labels[name]: clip for name, clip in scene.clips.items()}
            if clips:
                scenes.append(replace(scene, name=", ".join(clips), clips=clips))
        return scenes
