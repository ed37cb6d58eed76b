"""Running jobs of a study at the desk, watching them, and downloading their files."""

from collections.abc import Mapping
from typing import Any, Final

from flask import Response, abort, make_response, redirect, request, send_from_directory, url_for
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.database.tables.researchers import Event
from studyapp.desk.job_kinds import (
    FIGURES,
    KINDS,
    JobKind,
    reason_to_look,
    segment_names,
)
from studyapp.desk.jobs import Job, job_log, job_standings, run_job, stop_job
from studyapp.desk.lab import OpenedStudy, current_lab
from studyapp.desk.page import page, wrong_role
from studyapp.researchers.account import Right
from studyapp.web.research.pages import Page

MOST_SHOWN: Final = 64 * 1024
"""Bytes of a log that pages show, from its end."""

SHOWN_IN_PLACE: Final = (".html", ".png")
"""Endings of files that the browser shows; it downloads all others."""


def job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Show the last job of a kind, with its log and its files."""
    return _page(study, _visible_kind(study, kind))


def start_job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Run a job."""
    job_kind = _open_kind(study, kind)
    try:
        job = Job(
            kind=kind,
            command=job_kind.command(study, request.form),
            by=study.account.name,
            began_at=current_lab().clock.now(),
            packed=job_kind.packed,
        )
        run_job(study.folder.jobs, job)
    except InputError as error:
        return _page(study, job_kind, problem=error), 409
    _log(study, Event.JOB_BEGUN, job_kind.title)
    return redirect(url_for("research.job", study=study.name, kind=kind), 303)


def stop_running_job(study: OpenedStudy, kind: str) -> ResponseReturnValue:
    """Stop a job, whoever began it."""
    job_kind = _visible_kind(study, kind)
    stop_job(study.folder.jobs, kind, by=study.account.name)
    _log(study, Event.JOB_STOPPED, job_kind.title)
    return redirect(url_for("research.job", study=study.name, kind=kind), 303)


def job_file(study: OpenedStudy, kind: str, file: str) -> Response:
    """Send a file that a job has made."""
    job_kind = _open_kind(study, kind)
    folder = study.folder.root / job_kind.folder
    if not job_kind.folder or not (folder / file).is_file():
        abort(404)
    if job_kind.shows_answers:
        _log(study, Event.DOWNLOADED, f"{job_kind.title}: {file}")
    is_shown = file.endswith(SHOWN_IN_PLACE)
    return send_from_directory(folder.resolve(), file, as_attachment=not is_shown)


def job_archive(study: OpenedStudy, kind: str) -> Response:
    """Send all that a job has made as one archive."""
    job_kind = _open_kind(study, kind)
    standing = job_standings(study.folder.jobs).get(kind)
    if standing is None or standing.state != "done" or not job_kind.packed:
        abort(404)
    _log(study, Event.DOWNLOADED, job_kind.title)
    return send_from_directory(
        (study.folder.jobs / kind).resolve(),
        f"{standing.job.archive}.zip",
        as_attachment=True,
        download_name=f"{study.name}-{job_kind.name}.zip",
    )


def _visible_kind(study: OpenedStudy, name: str) -> JobKind:
    """Return the kind of job, if the researcher may know of it."""
    kind = KINDS.get(name)
    if kind is None:
        abort(404)
    if not study.account.may(kind.needs):
        abort(make_response(wrong_role()))
    return kind


def _open_kind(study: OpenedStudy, name: str) -> JobKind:
    """Return the kind of job, if the researcher may see its files now."""
    kind = _visible_kind(study, name)
    if not kind.is_open(study):
        raise InputError(
            "before the end, results are shown only to researchers who give a reason",
            remedy="Give one on the study's page of results, to which its page at the desk leads",
        )
    return kind


def _log(study: OpenedStudy, event: Event, detail: str) -> None:
    with study.database.writing() as session:
        study.log(session, event, detail)


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
    return any(standing.is_running for standing in standings.values())


def _files(study: OpenedStudy, kind: JobKind) -> list[tuple[str, str, int]]:
    """Return the files that can be opened, what each is called, and its bytes."""
    if not kind.folder:
        return []
    folder = study.folder.root / kind.folder
    listed = kind.files or [(path.name, path.name) for path in sorted(folder.glob("[!.]*"))]
    return [
        (name, title, (folder / name).stat().st_size)
        for name, title in listed
        if (folder / name).is_file()
    ]


def section(study: OpenedStudy, kinds: tuple[JobKind, ...]) -> Mapping[str, Any]:
    """Return what the study's page says of these kinds of jobs."""
    standings = job_standings(study.folder.jobs)
    may_look = reason_to_look(study) is not None
    return {
        "kinds": [
            kind
            for kind in kinds
            if study.account.may(kind.needs) and (may_look or not kind.shows_answers)
        ],
        "standings": standings,
        "is_busy": _is_busy(standings),
        "may_look": may_look,
    }


PAGES: Final = (
    Page("GET", "/jobs/<kind>", job, Right.WATCH),
    Page("POST", "/jobs/<kind>", start_job, Right.STEER),
    Page("POST", "/jobs/<kind>/stop", stop_running_job, Right.STEER),
    Page("GET", "/jobs/<kind>/archive", job_archive, Right.WATCH),
    Page("GET", "/jobs/<kind>/files/<path:file>", job_file, Right.WATCH),
)
