from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables import Place, StudySession, StudyVersion
from studyapp.rehearsal.record import Truth, read_truth
from studyapp.rehearsal.resumption import prepare, read_roster
from studyapp.rehearsal.simulation.population import Population, default_population
from studyapp.study.folder import StudyFolder
from tests.support.studies.stored import filled, opened

TRUTH = Truth(seed=1, study="", population=Population(quality={}), expected=())


@pytest.fixture
def begun(folder: StudyFolder) -> StudyFolder:
    """A folder with a rehearsal that was begun with seed 1."""
    prepare(folder, seed=1)
    Database.open(sqlite_url(folder.rehearsal)).close()
    return folder


@pytest.fixture
def database(begun: StudyFolder) -> Iterator[Database]:
    with opened(begun.rehearsal) as there:
        yield there


def change_the_study(folder: StudyFolder) -> None:
    text = folder.definition.read_text()
    folder.definition.write_text(text.replace("trials = 4", "trials = 3"))


def lose_the_truth(folder: StudyFolder) -> None:
    folder.rehearsal_truth.unlink()


@pytest.mark.parametrize(
    ("seed", "change", "said"),
    [
        (1, None, "is continued"),
        (2, None, "seed was 1, not 2"),
        (1, change_the_study, "the study has changed"),
        (1, lose_the_truth, "rehearsal.json"),
    ],
)
def test_the_same_rehearsal_is_gone_on_with_and_any_other_starts_anew_and_says_so(
    begun: StudyFolder, seed: int, change: Callable[[StudyFolder], None] | None, said: str
) -> None:
    if change is not None:
        change(begun)
    truth, note = prepare(begun, seed=seed)
    assert said in note
    assert bool(list(begun.root.glob("rehearsal.db*"))) == (said == "is continued")
    assert read_truth(begun.rehearsal_truth) == truth and truth.seed == seed


def test_other_people_start_anew_and_it_says_so(begun: StudyFolder) -> None:
    others = replace(default_population(begun.study()), kinds={"careless": 0.5})
    _, note = prepare(begun, seed=1, population=others)
    assert "another population" in note
    assert not begun.rehearsal.exists()


def store(database: Database, *study_sessions: tuple[str, bool, int | None]) -> None:
    """Store study sessions: who they are of, whether they are finished, and their place."""
    now = datetime.now(UTC)
    with database.writing() as session:
        session.add(filled(StudyVersion))
        session.flush()
        for name, finished, number in study_sessions:
            known = filled(StudySession, token=name, recruiter_participant=name, version_id=1)
            if finished:
                known.completed_at, known.completion_code = now, name
            if number is not None:
                known.place = filled(Place, number=number)
            session.add(known)


def test_the_roster_tells_who_is_where(database: Database) -> None:
    store(database, ("rehearsal-00002", True, 0), ("rehearsal-00001", False, 1))
    roster = read_roster(database, 4, TRUTH)
    assert roster.finished == ("rehearsal-00002",)
    assert roster.started == ("rehearsal-00001",)
    assert roster.awaited == ("rehearsal-00000", "rehearsal-00003")


def test_no_more_are_awaited_than_twice_as_many_as_there_are_places(database: Database) -> None:
    store(database, *((f"rehearsal-{number:05d}", True, None) for number in range(4)))
    roster = read_roster(database, 2, TRUTH)
    assert (roster.total, roster.remaining) == (4, ())
