"""What the tests of pages share."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from flask import Flask

from studyapp.web.app import create_app
from studyapp.web.site import attach, site_of
from tests.studyapp.web.visitor import Visitor
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import SetClock

Serve = Callable[..., Flask]


@pytest.fixture
def serve(tiny_study: Path, clock: SetClock) -> Iterator[Serve]:
    """Return a function that makes an application, on a clock that the test moves.

    It takes changes of the study file, as `redefine` does, another `folder` than the tiny study's,
    and what `create_app` takes. A rehearsal keeps its own clock.
    """
    with ExitStack() as closing:

        def make(
            *changes: tuple[str, str], folder: Path = tiny_study, added: str = "", **options: Any
        ) -> Flask:
            redefine(folder, *changes, added=added)
            app = create_app(folder, **options)
            site = site_of(app)
            closing.callback(site.database.close)
            if "rehearsal_speed" not in options:
                attach(app, replace(site, clock=clock))
            return app

        yield make


@pytest.fixture
def visitor(app: Flask, clock: SetClock) -> Visitor:
    """Return a participant at the first trial."""
    return Visitor(app, clock).enrol().begin()
