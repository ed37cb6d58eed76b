"""Serving a desk through gunicorn."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import ClassVar

from flask import Flask
from sqlalchemy.exc import SQLAlchemyError

from motion.errors import InputError
from studyapp.desk.app import create_desk, open_desk
from studyapp.desk.inbox import LARGEST_PIECE
from studyapp.desk.lab import Lab
from studyapp.monitoring.alarms import LOG, AlarmChannels, raise_alarms, watch_for_alarms
from studyapp.web.app import LARGEST_REQUEST
from studyapp.web.server import THREADS, WORKERS, require_free, serve_application
from studyapp.web.worker import StudyWorker


class DeskWorker(StudyWorker):
    """A study's worker that takes larger pieces of files."""

    largest_request: ClassVar[int] = LARGEST_PIECE + LARGEST_REQUEST


def run_desk(
    folder: Path,
    host: str,
    port: int,
    workers: int = WORKERS,
    *,
    threads: int = THREADS,
    origin: str = "",
    on_ready: Callable[[], None] | None = None,
) -> None:
    """Serve the studies in `folder` until the process is told to stop (SIGINT or SIGTERM).

    Parameters
    ----------
    folder : Path
        Holds the studies as sub-folders.
    origin : str
        What public addresses begin with; empty if unknown.
    host, port, workers, threads, on_ready
        See `studyapp.web.server.run_server`.

    Raises
    ------
    InputError
        Before anything is served: if there is no such folder, its database cannot be used, or the
        address is taken.
    """
    if os.environ.get("DATABASE_URL"):
        raise InputError(
            "a desk keeps the answers of each study in the study's own folder",
            where="the environment variable DATABASE_URL",
            remedy="Unset it; a study in PostgreSQL is served alone, with 'motionjury serve'",
        )
    if not folder.is_dir():
        raise InputError(
            "there is no such folder", where=folder, remedy="Make it; studies are its sub-folders"
        )
    require_free(host, port)
    # The workers find the newest schema and need not make it all at once.
    with closing(open_desk(folder).database):
        pass

    def make() -> Flask:
        lab = open_desk(folder, origin=origin)
        watch_for_alarms(partial(_raise_alarms, lab))
        return create_desk(lab)

    serve_application(
        make, host, port, workers, threads=threads, worker=DeskWorker, on_ready=on_ready
    )


def _raise_alarms(lab: Lab) -> None:
    """Send the alarms that are due in each study; one that cannot be read stops no other."""
    for study in lab.studies():
        try:
            served = study.served()
            channels = None if served is None else AlarmChannels.of(served.study)
            if served is not None and channels is not None and channels.is_any:
                raise_alarms(study.database, served, lab.clock, channels.send)
        except (InputError, SQLAlchemyError) as error:
            LOG.error("Alarms of %s: %s", study.name, type(error).__name__)
