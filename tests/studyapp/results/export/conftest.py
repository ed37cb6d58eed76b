from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from analysis.report.figures import ink
from studyapp.database.engine import Database, sqlite_url
from studyapp.session.arrival.enrolment import Arrival, enrol
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from tests.studyapp.answered_study import answer_study
from tests.studyapp.results.export.people import FORM, SAID
from tests.studyapp.taking_part_steps import Participant, SetClock


@pytest.fixture(autouse=True)
def at_home(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep to the database beside the study, and spare parts of fonts that nobody prints."""
    monkeypatch.delenv("DATABASE_URL", raising=False)
    monkeypatch.setitem(ink.STYLE, "pdf.fonttype", 3)


@pytest.fixture(scope="session")
def answered_once(
    finished_study: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Return a maker of answered studies of a protocol; each is made once, tests take copies."""
    made: dict[str, Path] = {}

    def make(protocol: str) -> Path:
        if protocol not in made:
            root = tmp_path_factory.mktemp("answered") / "study"
            shutil.copytree(finished_study(protocol), root)
            definition = root / "study.toml"
            definition.write_text(definition.read_text("utf-8") + FORM, "utf-8")
            answer_study(root, people=2, stop_after=1)
            _recruit(root)
            made[protocol] = root
        return made[protocol]

    return make


@pytest.fixture
def answered(answered_once: Callable[[str], Path], tmp_path: Path) -> Callable[[str], StudyFolder]:
    """Return a maker of studies in which two have taken part, and one is recruited by name."""

    def copy(protocol: str) -> StudyFolder:
        root = tmp_path / protocol
        shutil.copytree(answered_once(protocol), root)
        return StudyFolder(root)

    return copy


def _recruit(root: Path) -> None:
    """Let somebody come by a recruiter's link, say something, and look at the first trial."""
    database = Database.open(sqlite_url(root / "responses.db"))
    served = ServedStudy.read(root)
    clock = SetClock()
    open_study(database, served, clock)
    participant = Participant(database, served, clock)
    participant.token = enrol(database, served, Arrival(**SAID), clock)
    participant.begin().look()
    database.close()
