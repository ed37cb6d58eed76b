"""Running jobs of a study at the desk, watching them, and downloading what comes of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from flask import Response, abort, redirect, request, send_from_directory, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.tables import Event
from studyapp.desk.job_kinds import (
    FIGURES,
    KINDS,
    RUN,
    TAKE_HOME,
    JobKind,
    reason_to_look,
    segment_names,
)
from studyapp.desk.jobs import Job, job_log, job_standings, run_job, stop_job
from studyapp.desk.lab import OpenedStudy, current_lab
from studyapp.desk.page import Section, StudyPage, page
from studyapp.researchers.account import Right
from studyapp.researchers.audit import log_change

MOST_SHOWN: Final = 64 * 1024
"""Bytes of a log."""

SHOWN_IN_PLACE: Final = (".html", ".png")
"""Endings of files that the browser shows; all others are kept by it."""


def job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Show the last job of a kind, with its log and what has come of it."""
    return _page(study, _seen(study, kind))


def start_job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Run a job."""
    found = _opened(study, kind)
    now = current_lab().clock.now()
    try:
        command = found.command(study, request.form)
        begun = Job(
            kind=kind, command=command, by=study.account.name, began_at=now, packed=found.packed
        )
        run_job(study.folder.jobs, begun)
    except InputError as error:
        return _page(study, found, problem=error), 409
    _log(study, Event.JOB_BEGUN, found.title)
    return redirect(url_for("research.job", study=study.name, kind=kind), 303)


def stop_running_job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Have a job stop, whoever began it."""
    found = _seen(study, kind)
    stop_job(study.folder.jobs, kind, by=study.account.name)
    _log(study, Event.JOB_STOPPED, found.title)
    return redirect(url_for("research.job", study=study.name, kind=kind), 303)


def job_file(study: OpenedStudy, kind: str, file: str) -> Response:
    """Send a file that came of a job."""
    found = _opened(study, kind)
    folder = study.folder.root / found.place
    if not found.place or not (folder / file).is_file():
        abort(404)
    if found.shows_answers:
        _log(study, Event.DOWNLOADED, f"{found.title}: {file}")
    shown = file.endswith(SHOWN_IN_PLACE)
    return send_from_directory(folder.resolve(), file, as_attachment=not shown)


def job_archive(study: OpenedStudy, kind: str) -> Response:
    """Send all that came of a job as one file."""
    found = _opened(study, kind)
    standing = job_standings(study.folder.jobs).get(kind)
    if standing is None or standing.state != "done" or not found.packed:
        abort(404)
    _log(study, Event.DOWNLOADED, found.title)
    return send_from_directory(
        (study.folder.jobs / kind).resolve(),
        f"{standing.job.archive}.zip",
        as_attachment=True,
        download_name=f"{study.name}-{found.name}.zip",
    )


def _seen(study: OpenedStudy, kind: str) -> JobKind:
    """Return the kind of job, if the researcher may know of it."""
    found = KINDS.get(kind)
    if found is None:
        abort(404)
    if not study.account.may(found.sees):
        abort(403)
    return found


def _opened(study: OpenedStudy, kind: str) -> JobKind:
    """Return the kind of job, if the researcher may see now what comes of it."""
    found = _seen(study, kind)
    if not found.is_open(study):
        raise InputError(
            "results before the end are shown to whoever says why",
            remedy="Say so on the study's page of results, which the desk's page of it leads to",
        )
    return found


def _log(study: OpenedStudy, event: Event, detail: str) -> None:
    with study.database.writing() as session:
        log_change(session, current_lab().clock.now(), event, by=study.account.name, detail=detail)


def _page(study: OpenedStudy, kind: JobKind, *, problem: InputError | None = None) -> str:
    standings = job_standings(study.folder.jobs)
    return page(
        "job",
        study=study,
        kind=kind,
        standing=standings.get(kind.name),
        is_busy=_is_busy(standings),
        log=job_log(study.folder.jobs, kind.name, most=MOST_SHOWN),
        files=_files(study, kind),
        is_open=kind.is_open(study),
        problem=problem,
        figures=FIGURES,
        segments=segment_names(study) if kind.asks == "figure" else (),
    )


def _is_busy(standings: Mapping[str, Any]) -> bool:
    return any(each.is_running for each in standings.values())


def _files(study: OpenedStudy, kind: JobKind) -> list[tuple[str, str, int]]:
    """Return the files that can be opened, what each is called, and its bytes."""
    if not kind.place:
        return []
    folder = study.folder.root / kind.place
    names = [each.name for each in folder.glob("[!.]*")]
    listed = kind.opens or [(name, name) for name in sorted(names)]
    return [
        (name, words, (folder / name).stat().st_size)
        for name, words in listed
        if (folder / name).is_file()
    ]


def _told(study: OpenedStudy, kinds: tuple[JobKind, ...]) -> Mapping[str, Any]:
    standings = job_standings(study.folder.jobs)
    return {
        "kinds": [kind for kind in kinds if study.account.may(kind.sees)],
        "standings": standings,
        "is_busy": _is_busy(standings),
        "may_look": reason_to_look(study) is not None,
    }


SECTIONS: Final = (
    Section("jobs", "Run", Right.WATCH, lambda study: _told(study, RUN)),
    Section("take_home", "Take home", Right.UNBLIND, lambda study: _told(study, TAKE_HOME)),
)

PAGES: Final = (
    StudyPage("GET", "/jobs/<kind>", job, Right.WATCH),
    StudyPage("POST", "/jobs/<kind>", start_job, Right.STEER),
    StudyPage("POST", "/jobs/<kind>/stop", stop_running_job, Right.STEER),
    StudyPage("GET", "/jobs/<kind>/archive", job_archive, Right.WATCH),
    StudyPage("GET", "/jobs/<kind>/files/<path:file>", job_file, Right.WATCH),
)
