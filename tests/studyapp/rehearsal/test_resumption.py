from dataclasses import replace
from datetime import UTC, datetime

import pytest

from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.study_session import Place, StudySession, StudyVersion
from studyapp.rehearsal.bookkeeping import Ledger
from studyapp.rehearsal.resumption import Roster, prepare, read_roster
from studyapp.rehearsal.simulation.population import default_population
from studyapp.rehearsal.simulation.truth import read_truth
from studyapp.study.folder import StudyFolder
from tests.support.studies.stored import filled, opened


def spoil(folder: StudyFolder, what: str) -> None:
    if what == "study":
        text = folder.definition.read_text()
        folder.definition.write_text(text.replace("trials = 4", "trials = 3"))
    if what == "record":
        folder.rehearsal_truth.write_text('{"seed": 1, "population": {"weak": 9}}')


@pytest.mark.parametrize(
    ("seed", "changed"), [(1, ""), (2, ""), (1, "study"), (1, "record"), (1, "population")]
)
def test_a_rehearsal_resumes_only_with_the_same_settings(
    folder: StudyFolder, seed: int, changed: str
) -> None:
    folder.responses.write_bytes(b"real answers")
    prepare(folder, seed=1)
    Database.open(sqlite_url(folder.rehearsal)).close()
    Ledger(folder.acknowledged).note("rehearsal-00000", code="CODE")
    people = default_population(folder.study())
    spoil(folder, changed)

    others = replace(people, kinds={"careless": 0.5}) if changed == "population" else None
    truth, note = prepare(folder, seed=seed, population=others)

    is_continued = seed == 1 and not changed
    assert ("is continued" if is_continued else "were removed") in note
    assert bool(list(folder.root.glob("rehearsal.db*"))) == is_continued
    assert bool(Ledger(folder.acknowledged).read().codes) == is_continued
    assert read_truth(folder.rehearsal_truth) == truth
    assert truth.seed == seed
    assert folder.responses.read_bytes() == b"real answers"


def roster(folder: StudyFolder, count: int, *arrived: tuple[int, bool, int | None]) -> Roster:
    """Return the roster after this many arrivals: each with its number, whether done, and its
    place."""
    truth, _ = prepare(folder, seed=1)
    now = datetime.now(UTC)
    with opened(folder.rehearsal) as database:
        with database.writing() as session:
            session.add(filled(StudyVersion))
            session.flush()
            for number, finished, place in arrived:
                name = f"rehearsal-{number:05d}"
                known = filled(StudySession, token=name, recruiter_participant=name, version_id=1)
                if finished:
                    known.completed_at, known.completion_code = now, name
                if place is not None:
                    known.place = filled(Place, number=place)
                session.add(known)
        return read_roster(database, count, truth)


def test_the_roster_has_at_most_twice_as_many_participants_as_places(folder: StudyFolder) -> None:
    begun = roster(folder, 4, (2, True, 0), (1, False, 1))
    assert begun.finished == ("rehearsal-00002",)
    assert begun.remaining == ("rehearsal-00001", "rehearsal-00000", "rehearsal-00003")
    folder.rehearsal.unlink()
    full = roster(folder, 2, *((number, True, None) for number in range(4)))
    assert (full.total, full.remaining) == (4, ())
