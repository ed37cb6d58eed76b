"""What every request needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, cast

from flask import Flask, current_app

from studyapp.clock import Clock
from studyapp.database.engine import Database
from studyapp.researchers.interim.computing import FigureProcess
from studyapp.session.served_study import ServedStudy, VideoRecord
from studyapp.study.settings.study import Study
from studyapp.web.media_store.store import MediaStore

EXTENSION: Final = "motionjury"


@dataclass(frozen=True, kw_only=True)
class Running:
    """The study being served, its database and its clock.

    Attributes
    ----------
    folder : Path
        The study folder.
    record : VideoRecord
        Tells whether its videos are still those that are served.
    figures : FigureProcess
        Computes what pages of researchers show of the answers so far.
    accel_prefix : str or None
        Where a proxy in front finds that folder; None where this server sends the videos itself.
    store : MediaStore or None
        Where participants load the videos from instead.
    origin : str
        What the study's public addresses begin with, before the path; empty where nobody said so.
    """

    served: ServedStudy
    database: Database
    clock: Clock
    folder: Path
    record: VideoRecord
    figures: FigureProcess
    accel_prefix: str | None = None
    store: MediaStore | None = None
    origin: str = ""

    @property
    def study(self) -> Study:
        """The study's definition."""
        return self.served.study


def attach(app: Flask, running: Running) -> None:
    """Make `running` known to the requests of `app`."""
    app.extensions[EXTENSION] = running


def running() -> Running:
    """Return what the present request needs."""
    return cast(Running, current_app.extensions[EXTENSION])
