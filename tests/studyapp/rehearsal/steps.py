"""Simulated participants in the real application, without a server in between."""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from threading import Event

import httpx
from flask import Flask

from studyapp.database.engine import Database
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.eyes import Eyes
from studyapp.rehearsal.participant import Participant
from studyapp.rehearsal.simulation.population import default_population
from studyapp.study.folder import StudyFolder
from studyapp.web.app import create_app
from studyapp.web.site import EXTENSION

SPEED = 200.0


class SpoiltTransport(httpx.WSGITransport):
    """Changes pages on their way to the participant."""

    def __init__(self, app: Flask, spoil: Callable[[str], str]) -> None:
        super().__init__(app)
        self.spoil = spoil

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        response = super().handle_request(request)
        if not response.headers.get("content-type", "").startswith("text/html"):
            return response
        html = self.spoil(response.read().decode())
        headers = {k: v for k, v in response.headers.items() if k.lower() != "content-length"}
        return httpx.Response(response.status_code, headers=headers, text=html)


@contextmanager
def application(folder: StudyFolder, speed: float | None) -> Iterator[Flask]:
    """Give the real application; a rehearsal's has a speed."""
    made = create_app(folder.root, rehearsal_speed=speed)
    with closing(made.extensions[EXTENSION].database):
        yield made


def browser(app: Flask, spoil: Callable[[str], str] = str) -> httpx.Client:
    """Return a browser whose pages `spoil` may change."""
    return httpx.Client(
        transport=SpoiltTransport(app, spoil), base_url="http://study.test", follow_redirects=True
    )


def participant_of(folder: StudyFolder, database: Database, name: str = "p1") -> Participant:
    """Return an attentive participant of a rehearsal whose answers go to `database`."""
    study = folder.study()
    return Participant(
        name=name,
        study=study,
        population=replace(default_population(study), kinds={}),
        seed=1,
        eyes=Eyes(database),
        speed=SPEED,
        stop=Event(),
        ledger=Ledger(folder.acknowledged),
    )
