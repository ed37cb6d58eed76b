"""The contact sheet of a study: every rendered clip at a glance, for the researcher."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import digest, replacing, write_text
from motion.segment import Segment
from renderer.figures.glance import glance_at
from renderer.figures.sheet import Cell, Sheet, SheetCell, draw_cell, sheet_page, sheet_pictures
from renderer.look import CELL_VERSION
from studyapp.stimuli.figures.motion_pages import MotionPages
from studyapp.stimuli.render_plan import video_look
from studyapp.study.folder import StudyFolder
from studyapp.study.media import StimulusVideo, stimulus_videos
from studyapp.study.settings.study import Study

_UNSHOWN: Final = SheetCell(cell=None, remark="is not shown to participants", video="")


def write_contact_sheet(
    folder: StudyFolder,
    *,
    threads: int,
    on_done: Callable[[int, int], None] = lambda done, total: None,
) -> Path:
    """Write the sheet from the rendered videos, and return its HTML page.

    Beside the page stand the same cells as PNG pages. Cells of videos that have not changed are
    kept from the last time.

    Parameters
    ----------
    folder : StudyFolder
        The study; a clip without video gets an empty cell that says so.
    threads : int
        How many videos are looked at at once.
    on_done : callable
        Called with (cells done, cells in all) after each.
    """
    study = folder.study()
    segments = tuple(folder.segments_of(study))
    shown = {(s.segment, s.condition) for content in study.contents(segments) for s in content}
    everything = (*study.conditions, study.catch.condition)
    named = {name for _, name in shown}
    conditions = tuple(name for name in everything if name in named)
    wanted = [(segment.name, name) for segment in segments for name in conditions]
    clips = stimulus_videos(folder, study, shown)
    place = folder.videos / "sheet"
    moving = MotionPages(folder, study, clips)
    steps = len(wanted) + len(segments)
    entries: dict[tuple[str, str], SheetCell] = {}
    with ThreadPoolExecutor(threads) as pool:
        made = pool.map(
            lambda key: _entry(place, clips.get(key), study, key[1]) if key in shown else _UNSHOWN,
            wanted,
        )
        for number, (key, entry) in enumerate(zip(wanted, made, strict=True), 1):
            entries[key] = entry
            on_done(number, steps)
    motion: dict[str, str] = {}
    for number, segment in enumerate(segments, len(wanted) + 1):
        written_page = moving.write(place / "motion", segment, conditions)
        if written_page is not None:
            motion[segment.name] = written_page.relative_to(place).as_posix()
        on_done(number, steps)
    called = study.display_names
    sheet = Sheet(
        title=study.title,
        facts=_facts(study, segments, conditions, len(clips)),
        conditions=tuple(called[name] for name in conditions),
        roles={called[name]: role for name, role in study.roles.items()},
        segments=segments,
        cells={(segment, called[name]): entry for (segment, name), entry in entries.items()},
        motion=motion,
    )
    page = place / "index.html"
    write_text(page, sheet_page(sheet))
    written = {page}
    for number, picture in enumerate(sheet_pictures(sheet), 1):
        path = place / f"sheet-{number:02}.png"
        with replacing(path) as draft:
            picture.save(draft, "PNG")
        written.add(path)
    kept = {_kept(place, video) for video in clips.values()}
    kept |= {place / address for address in motion.values()}
    drawn = (place.glob("sheet-*.png"), (place / ".cells").glob("*.webp"))
    for path in chain(*drawn, (place / "motion").glob("*.html")):
        if path not in written | kept:
            path.unlink()
    return page


def _entry(place: Path, clip: StimulusVideo | None, study: Study, condition: str) -> SheetCell:
    """Return the cell of a condition's clip, drawn where it is not kept."""
    brought = study.is_finished(condition)
    if clip is None:
        todo = "bring it" if brought else "run 'motionjury render'"
        return SheetCell(cell=None, remark=f"there is no video: {todo}", video="")
    kept = _kept(place, clip)
    video = f"../../{clip.file.relative_to(place.parent.parent).as_posix()}"
    if not kept.exists():
        try:
            cell = draw_cell(glance_at(clip.file, None if brought else video_look(study)))
        except InputError as error:
            return SheetCell(cell=None, remark=error.what, video=video)
        with replacing(kept) as draft:
            draft.write_bytes(cell.data)
    else:
        cell = Cell(kept.read_bytes())
    return SheetCell(cell=cell, remark="; ".join(cell.remarks), video=video)


def _kept(place: Path, clip: StimulusVideo) -> Path:
    """Return where the cell of a clip is kept."""
    return place / ".cells" / f"{digest(CELL_VERSION, clip.key)}.webp"


def _facts(study: Study, segments: Sequence[Segment], conditions: Sequence[str], clips: int) -> str:
    video = study.video
    return (
        f"{clips} clips of {len(segments)} segments in "
        f"{len(conditions)} conditions, {video.size} pixels, "
        f"{video.frame_rate} frames per second"
    )
