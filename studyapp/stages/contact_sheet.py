"""The contact sheet of a study: every rendered clip at a glance, for the researcher."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Final

from motion.errors import InputError
from motion.files import replacing, write_text
from motion.segment import Segment
from motion.source_version import imported_sources, source_version
from renderer.figures.glance import glance_at
from renderer.figures.sheet import Sheet, SheetCell, sheet_page, sheet_pictures
from renderer.figures.sheet_cell import Cell, draw_cell
from studyapp.definition.folder import StudyFolder
from studyapp.definition.stimuli import ClipVideo, read_stimuli
from studyapp.definition.study import Study
from studyapp.stages.digest import digest

_VERSION: Final = source_version(imported_sources(["renderer.figures.sheet_cell"]))


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
        The study; a clip without a video gets an empty cell that says so.
    threads : int
        How many videos are looked at at once.
    on_done : callable
        Called with (cells done, cells in all) after each.
    """
    study = folder.study()
    segments = tuple(folder.segments())
    clips = {(clip.segment, clip.condition): clip for clip in read_stimuli(folder.stimuli).clips}
    wanted = [(segment.name, name) for segment in segments for name in study.shown_conditions]
    place = folder.videos / "sheet"
    entries: dict[tuple[str, str], SheetCell] = {}
    with ThreadPoolExecutor(threads) as pool:
        made = pool.map(lambda key: _entry(folder, place, clips.get(key)), wanted)
        for number, (key, entry) in enumerate(zip(wanted, made, strict=True), 1):
            entries[key] = entry
            on_done(number, len(wanted))
    sheet = Sheet(
        title=study.title,
        facts=_facts(study, segments, clips.values()),
        conditions=study.shown_conditions,
        roles=_roles(study),
        segments=segments,
        cells=entries,
    )
    page = place / "index.html"
    write_text(page, sheet_page(sheet))
    written = {page}
    for number, picture in enumerate(sheet_pictures(sheet), 1):
        path = place / f"sheet-{number:02}.png"
        with replacing(path) as draft:
            picture.save(draft, "PNG")
        written.add(path)
    kept = {_kept(place, clip) for clip in clips.values()}
    for path in (*place.glob("sheet-*.png"), *(place / ".cells").glob("*.webp")):
        if path not in written | kept:
            path.unlink()
    return page


def _entry(folder: StudyFolder, place: Path, clip: ClipVideo | None) -> SheetCell:
    """Return the cell of a clip, drawn where it is not kept."""
    if clip is None or not (folder.root / clip.file).exists():
        return SheetCell(cell=None, remark="there is no video: run 'motionjury render'", video="")
    kept = _kept(place, clip)
    video = f"../../{clip.file}"
    if not kept.exists():
        try:
            cell = draw_cell(glance_at(folder.root / clip.file))
        except InputError as error:
            return SheetCell(cell=None, remark=error.what, video=video)
        with replacing(kept) as draft:
            draft.write_bytes(cell.data)
    else:
        cell = Cell(kept.read_bytes())
    return SheetCell(cell=cell, remark="; ".join(cell.remarks), video=video)


def _kept(place: Path, clip: ClipVideo) -> Path:
    """Return where the cell of a clip is kept."""
    return place / ".cells" / f"{digest(_VERSION, clip.key)}.webp"


def _facts(study: Study, segments: Iterable[Segment], clips: Iterable[ClipVideo]) -> str:
    video = study.video
    return (
        f"{len(list(clips))} clips of {len(list(segments))} segments in "
        f"{len(study.shown_conditions)} conditions, {video.size} pixels, "
        f"{video.frame_rate} frames per second"
    )


def _roles(study: Study) -> dict[str, str]:
    """Return what conditions are in the study."""
    return {study.reference: "reference", study.catch.condition: "catch trials"}
