"""What the tests of the study app share."""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Literal
from uuid import uuid4

import pytest
from argon2 import PasswordHasher
from flask import Flask

from studyapp.database.engine import Database, sqlite_url
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.stimuli.recordings import Take
from studyapp.study.folder import StudyFolder
from studyapp.study.study_file import new_study
from studyapp.web.app import create_app
from studyapp.web.site import attach, site_of
from tests.support.fast_applications import fast_applications
from tests.support.in_process_figures import InProcessFigures
from tests.support.in_process_rendering import rendering_in_process
from tests.support.servers.s3_stand_in import Store, s3_stand_in, use_keys
from tests.support.servers.throwaway_postgresql import (
    ThrowawayPostgresql,
    programs,
    throwaway_postgresql,
)
from tests.support.studies.emptying import empty
from tests.support.studies.finished_study import write_finished_study, write_short_video
from tests.support.studies.takes import write_motion, write_speech
from tests.support.studies.taking_part_steps import Participant, SetClock

DatabaseKind = Literal["sqlite", "postgresql"]
OwnStudy = Callable[[str], StudyFolder]


BOTH_DATABASES = (
    "database/test_copies",
    "database/test_engine",
    "researchers/test_account",
    "session",
)
"""Where all tests are repeated on both databases; elsewhere only tests marked `BOTH`."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Repeat a test that uses a database on SQLite and on PostgreSQL, unless it says which."""
    module = Path(metafunc.module.__file__ or "").relative_to(Path(__file__).parent).as_posix()
    chosen = [mark.args[0] for mark in metafunc.definition.iter_markers("parametrize")]
    if (
        module.startswith(BOTH_DATABASES)
        and "database_url" in metafunc.fixturenames
        and "database_url" not in chosen
    ):
        metafunc.parametrize("database_url", ["sqlite", "postgresql"], indirect=True)


@pytest.fixture(scope="session")
def finished_study(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Return a function that writes the finished study of a protocol once; tests take copies."""
    root = tmp_path_factory.mktemp("finished-studies")
    write_short_video(root / "short.mp4")

    @cache
    def write(protocol: str) -> Path:
        folder = root / protocol
        folder.mkdir()
        write_finished_study(folder, protocol, root / "short.mp4")
        return folder

    return write


@pytest.fixture
def own_study(finished_study: Callable[[str], Path], tmp_path: Path) -> OwnStudy:
    """Return a function that gives a test its own copy of a protocol's finished study."""

    def copy(protocol: str) -> StudyFolder:
        return StudyFolder(Path(shutil.copytree(finished_study(protocol), tmp_path / protocol)))

    return copy


@pytest.fixture
def clock() -> SetClock:
    return SetClock()


@pytest.fixture(scope="session", autouse=True)
def _fast_applications() -> Iterator[None]:
    with fast_applications(), pytest.MonkeyPatch.context() as patch:
        # The answers of these studies are beside them, or where a test says.
        patch.delenv("DATABASE_URL", raising=False)
        yield


@pytest.fixture(scope="module", autouse=True)
def _rendering_in_process() -> Iterator[None]:
    with rendering_in_process():
        yield


@pytest.fixture(scope="session", autouse=True)
def _cheap_passwords() -> Iterator[None]:
    """Hash passwords of researchers at next to no cost."""
    with pytest.MonkeyPatch.context() as patch:
        cheap = PasswordHasher(time_cost=1, memory_cost=8, parallelism=1)
        patch.setattr("studyapp.researchers.credentials.HASHER", cheap)
        yield


@pytest.fixture
def served(tiny_study: Path) -> ServedStudy:
    return ServedStudy.read(tiny_study)


@pytest.fixture(scope="session")
def postgresql() -> Iterator[ThrowawayPostgresql]:
    """Return a running PostgreSQL server, or skip the test."""
    if programs() is None:
        pytest.skip("PostgreSQL (Debian's package) is not installed")
    with throwaway_postgresql(durable=False) as server:
        yield server


@pytest.fixture(scope="session")
def shared_postgresql(postgresql: ThrowawayPostgresql) -> Iterator[Database]:
    """Return the PostgreSQL database that tests share, with the newest schema."""
    database = Database.open(postgresql.url)
    yield database
    database.close()


@pytest.fixture(scope="session")
def empty_sqlite(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an SQLite file of the newest schema that holds nothing; tests take copies."""
    file = tmp_path_factory.mktemp("empty-database") / "empty.db"
    Database.open(sqlite_url(file)).close()
    return file


@pytest.fixture
def database_url(request: pytest.FixtureRequest, tmp_path: Path, empty_sqlite: Path) -> str:
    """Return the address of a database: SQLite, or of the kind that the test is repeated for."""
    kind: DatabaseKind = getattr(request, "param", "sqlite")
    if kind == "postgresql":
        empty(request.getfixturevalue("shared_postgresql"))
        server: ThrowawayPostgresql = request.getfixturevalue("postgresql")
        return server.url
    return sqlite_url(shutil.copyfile(empty_sqlite, tmp_path / "responses.db"))


@pytest.fixture
def empty_url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    """Return the address of a database without tables: SQLite, or of the kind asked for."""
    kind: DatabaseKind = getattr(request, "param", "sqlite")
    if kind == "sqlite":
        yield sqlite_url(tmp_path / "empty.db")
        return
    server: ThrowawayPostgresql = request.getfixturevalue("postgresql")
    name = f"empty_{uuid4().hex}"
    yield server.create_database(name)
    server.drop_database(name)


@pytest.fixture
def database(database_url: str) -> Iterator[Database]:
    opened = Database.open(database_url)
    yield opened
    opened.close()


@pytest.fixture
def opened(database: Database, served: ServedStudy, clock: SetClock) -> Database:
    """Return a database that knows the study and its places."""
    open_study(database, served, clock)
    return database


@pytest.fixture
def app(tiny_study: Path, clock: SetClock) -> Iterator[Flask]:
    """Return the application of `tiny_study` on a clock that the test moves."""
    made = create_app(tiny_study)
    site = site_of(made)
    url = sqlite_url(tiny_study / "responses.db")
    attach(made, replace(site, clock=clock, figures=InProcessFigures(site.folder, url)))
    yield made
    site.database.close()


@pytest.fixture
def participant(opened: Database, served: ServedStudy, clock: SetClock) -> Participant:
    """Return a participant at the first trial."""
    return Participant(opened, served, clock).enrol().begin()


@pytest.fixture
def s3_store(monkeypatch: pytest.MonkeyPatch) -> Iterator[Store]:
    """Return an empty S3-compatible store with its keys in the environment."""
    use_keys(monkeypatch)
    with s3_stand_in() as running_store:
        yield running_store


@pytest.fixture
def folder(tmp_path: Path) -> StudyFolder:
    made = StudyFolder(tmp_path / "study")
    new_study(made.definition, name="study", trials=2)
    return made


@pytest.fixture
def speech_file(tmp_path: Path) -> Callable[..., Path]:
    def write(seconds: float, name: str = "take") -> Path:
        return write_speech(tmp_path / f"{name}.wav", seconds)

    return write


@pytest.fixture
def motion_file(tmp_path: Path) -> Callable[..., Path]:
    def write(seconds: float, frame_rate: float = 30, name: str = "motion") -> Path:
        return write_motion(tmp_path / f"{name}.npz", seconds, frame_rate)

    return write


@pytest.fixture
def take(speech_file: Callable[..., Path], motion_file: Callable[..., Path]) -> Callable[..., Take]:
    def make(
        *, speech: float = 6.0, motion: float = 6.0, segment: float | None = 2.0, name: str = "take"
    ) -> Take:
        return Take(
            motion=motion_file(motion),
            speech=speech_file(speech, name),
            segment_seconds=segment,
            condition="ground_truth",
            speaker="scott",
            emotion="neutral",
        )

    return make
