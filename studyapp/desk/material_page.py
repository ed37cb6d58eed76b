"""The clips of a study: a table of all segments and conditions, and a page for each segment."""

import json
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, Final, Literal

from flask import Response, abort, redirect, request, send_file, url_for
from flask.typing import ResponseReturnValue
from sqlalchemy import select
from sqlalchemy.orm import Session

from motion.endings import VIDEO_ENDING
from motion.errors import InputError
from motion.segment import Segment
from studyapp.database.tables.researchers import Event
from studyapp.database.tables.trial import TrialStimulus
from studyapp.desk.inbox import Inbox
from studyapp.desk.job_kinds import RECORD
from studyapp.desk.jobs import no_other_job
from studyapp.desk.lab import OpenedStudy
from studyapp.desk.page import page
from studyapp.researchers.account import Right
from studyapp.study.design.trial import Stimulus
from studyapp.study.folder import StudyFolder
from studyapp.study.media import finished_video_path, recorded_stimuli, remove_segment_files
from studyapp.web.research.motion_scenes import Scene, scenes_of, send_scene
from studyapp.web.research.pages import Page

State = Literal["missing", "motion", "video"]


Finding = Mapping[str, str]
"""What `motionjury check` writes down of each, see ``docs/check.schema.json``."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One segment in one condition.

    Attributes
    ----------
    label : str
        What the condition is called.
    source : Path
        Where its motion, or its finished video, belongs, whether it is there or not.
    video : Path or None
        What can be played of it.
    findings : tuple
        What the last check found wrong with its files, unless they have changed since.
    """

    condition: str
    label: str
    source: Path
    video: Path | None
    findings: tuple[Finding, ...]

    @property
    def state(self) -> State:
        """Whether it can be played, is there, or is missing."""
        if self.video is not None:
            return "video"
        return "motion" if self.source.is_file() else "missing"

    @property
    def has_motion(self) -> bool:
        """Whether it can be turned around."""
        return self.source.suffix != VIDEO_ENDING and self.source.is_file()

    @property
    def is_bad(self) -> bool:
        """Whether something that is there must be fixed."""
        return self.state != "missing" and any(
            finding["severity"] == "error" for finding in self.findings
        )


class Material:
    """All clips of a study, by segment and condition.

    Attributes
    ----------
    conditions : tuple of str
        The catch condition comes last.
    checked_at : float
        When the desk last checked the study, in seconds since 1970; 0 if it never has.

    Raises
    ------
    InputError
        If the study file, the segments or the list of videos cannot be read.
    """

    def __init__(self, folder: StudyFolder) -> None:
        self.folder = folder
        self.study = folder.study()
        segments = folder.segments_of(self.study)
        self.segments = {each.name: each for each in segments}
        catch = (self.study.catch.condition,) if self.study.catch.trials else ()
        self.conditions = (*self.study.conditions, *catch)
        stimuli = recorded_stimuli(folder.stimuli)
        self._clips = {
            (clip.segment, clip.condition): clip.file
            for clip in stimuli.clips
            if clip.speech is None
        }
        self._shown_in: defaultdict[tuple[str, str], list[str]] = defaultdict(list)
        for pair in stimuli.pairs:
            for condition in (pair.left, pair.right):
                self._shown_in[pair.segment, condition].append(pair.file)
        for copy in stimuli.copies:
            self._shown_in[copy.segment, copy.condition].append(copy.file)
        self._findings: defaultdict[str, list[Finding]] = defaultdict(list)
        self.checked_at, findings = _read_findings(folder.root / RECORD)
        for finding in findings:
            self._findings[finding["where"]].append(finding)

    def _cell(self, segment: str, condition: str) -> Cell:
        clip = self._clips.get((segment, condition), "")
        if self.study.is_finished(condition):
            source = finished_video_path(self.folder.videos, Stimulus.own(condition, segment))
            video = source
        else:
            source = self.folder.clip(condition, segment)
            video = self.folder.root / clip
        source_name = source.relative_to(self.folder.root).as_posix()
        # Findings of no file are about the whole study.
        files = dict.fromkeys(
            filter(None, (source_name, clip, *self._shown_in[segment, condition]))
        )
        return Cell(
            condition=condition,
            label=self.study.display_names[condition],
            source=source,
            video=video if video.is_file() else None,
            findings=tuple(finding for file in files for finding in self._current_findings(file)),
        )

    def _current_findings(self, file: str) -> list[Finding]:
        """Return the findings of a file, unless it was changed or removed since the check."""
        findings = self._findings[file]
        try:
            # An upload keeps the time at which it was written elsewhere.
            changed_at = (self.folder.root / file).stat().st_ctime
        except OSError:
            return [finding for finding in findings if finding["name"] == "video-missing"]
        return findings if changed_at <= self.checked_at else []

    def row(self, segment: str) -> list[Cell]:
        """Return the cell of a segment in every condition."""
        return [self._cell(segment, condition) for condition in self.conditions]

    def rows(self) -> list[tuple[Segment, list[Cell]]]:
        """Return each segment with its cells."""
        return [(segment, self.row(name)) for name, segment in self.segments.items()]


def _read_findings(record: Path) -> tuple[float, tuple[Finding, ...]]:
    """Return when the study was last checked, and the findings; 0 and none if nobody can tell."""
    try:
        findings = json.loads(record.read_bytes())["findings"]
        return record.stat().st_mtime, tuple(findings)
    except (OSError, ValueError):
        return 0.0, ()


def material(study: OpenedStudy) -> ResponseReturnValue:
    """Show the table of segments and conditions."""
    try:
        clips = Material(study.folder)
    except InputError as error:
        return page("material", study=study, problem=error, rows=[], material=None)
    rows = clips.rows()
    return page("material", study=study, material=clips, rows=rows, counts=_counts(rows))


def summary(study: OpenedStudy) -> Mapping[str, Any]:
    """Return what the study's page says of its material."""
    waiting = len(Inbox(study.folder).files())
    try:
        clips = Material(study.folder)
    except InputError as error:
        return {"problem": error, "waiting": waiting}
    return {"problem": None, "waiting": waiting, "counts": _counts(clips.rows()), "material": clips}


def _counts(rows: Sequence[tuple[Segment, Sequence[Cell]]]) -> Mapping[str, int]:
    cells = [cell for _, row in rows for cell in row]
    return {
        "all": len(cells),
        "there": sum(cell.state != "missing" for cell in cells),
        "bad": sum(cell.is_bad for cell in cells),
    }


def segment_page(study: OpenedStudy, segment: str) -> ResponseReturnValue:
    """Show one segment in all conditions, with its motion side by side."""
    clips, cells = _row(study, segment)
    return page(
        "segment",
        study=study,
        material=clips,
        segment=clips.segments[segment],
        cells=cells,
        scenes=_scenes(segment, cells),
        generated=clips.study.generated(),
    )


def clip_video(study: OpenedStudy, segment: str, condition: str) -> Response:
    """Send the video of one segment in one condition."""
    _, cells = _row(study, segment)
    video = next((cell.video for cell in cells if cell.condition == condition), None)
    if video is None:
        abort(404)
    return send_file(video.resolve(), mimetype="video/mp4", conditional=True)


def segment_scene(study: OpenedStudy, segment: str, scene: int) -> Response:
    """Send what a viewer plays of one segment in several conditions."""
    _, cells = _row(study, segment)
    return send_scene(study.folder.root, _scenes(segment, cells), scene)


def _row(study: OpenedStudy, segment: str) -> tuple[Material, list[Cell]]:
    clips = Material(study.folder)
    if segment not in clips.segments:
        abort(404)
    return clips, clips.row(segment)


def _scenes(segment: str, cells: Sequence[Cell]) -> list[Scene]:
    clips = [(cell.label, cell.condition) for cell in cells if cell.has_motion]
    return scenes_of(segment, segment, clips)


def remove_material(study: OpenedStudy, segment: str) -> ResponseReturnValue:
    """Remove one segment in the condition that the form names, or in all, and its speech.

    Not unconfirmed, during a job, or from participants.
    """
    clips, cells = _row(study, segment)
    sources = {cell.condition: cell.source for cell in cells}
    condition = request.form.get("condition", "")
    if condition and condition not in sources:
        abort(404)
    if "sure" not in request.form:
        raise InputError("nothing was removed", remedy="Tick the box to remove it for good")
    if not condition and len(clips.segments) == 1:
        raise InputError(
            "the last segment cannot be removed", remedy="Bring in others first, then remove it"
        )
    with no_other_job(study.folder.jobs), study.database.writing() as session:
        if any(
            segment in (shown.segment, shown.speech) and condition in ("", shown.condition)
            for shown in _shown_stimuli(study, session)
        ):
            raise InputError(
                "people have taken part, and what they see cannot be removed",
                remedy="Make another study without it",
            )
        if condition:
            sources[condition].unlink(missing_ok=True)
            removed = sources[condition].relative_to(study.folder.root).as_posix()
        else:
            remove_segment_files(study.folder, segment)
            removed = f"segment {segment}"
        study.log(session, Event.MATERIAL_REMOVED, removed)
    return redirect(url_for("research.material", study=study.name), 303)


def _shown_stimuli(study: OpenedStudy, session: Session) -> list[Stimulus]:
    """Return what participants see or will see; nothing before the first of them."""
    columns = (TrialStimulus.condition, TrialStimulus.segment, TrialStimulus.speech)
    rows = session.execute(select(*columns).distinct()).mappings()
    shown = [Stimulus(**row) for row in rows]
    served = study.study.served()
    return [*shown, *chain(*served.videos)] if shown and served else shown


SEGMENT: Final = "/material/<segment>"

PAGES: Final = (
    Page("GET", "/material", material, Right.WATCH),
    Page("GET", SEGMENT, segment_page, Right.WATCH),
    Page("GET", f"{SEGMENT}/<condition>.mp4", clip_video, Right.WATCH),
    Page("GET", f"{SEGMENT}/motion/<int:scene>", segment_scene, Right.WATCH),
    Page("POST", f"{SEGMENT}/remove", remove_material, Right.STEER),
)
