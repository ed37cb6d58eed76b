"""Whatever is read of a study's answers belongs to one moment, on both databases."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Engine, event

from studyapp.database.tables.study_session import StudySession
from studyapp.results.export.sharing import share
from studyapp.results.export.tables import export
from studyapp.results.looks import figures_so_far
from studyapp.study.folder import StudyFolder
from tests.support.studies.taking_part_steps import Participant

Reader = Callable[[StudyFolder, Path], object]


def exported(folder: StudyFolder, out: Path) -> object:
    export(folder, out / "answers.csv", with_recruiter_ids=True)
    return {
        path.name: path.read_text("utf-8") for path in out.glob("*.csv") if "log" not in path.name
    }


def shared(folder: StudyFolder, out: Path) -> object:
    share(folder, out / "folder")
    files = (path for path in (out / "folder").rglob("*") if path.is_file())
    return {path.relative_to(out): path.read_bytes() for path in files}


def live(folder: StudyFolder, _out: Path) -> object:
    return figures_so_far(folder, "agreement")


@pytest.mark.parametrize(
    ("reader", "database_url"),
    [*((reader, "sqlite") for reader in (exported, shared, live)), (exported, "postgresql")],
    indirect=["database_url"],
)
def test_a_withdrawal_during_reading_is_seen_everywhere_or_nowhere(
    participant: Participant,
    tiny_study: Path,
    tmp_path: Path,
    database_url: str,
    reader: Reader,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("DATABASE_URL", database_url)
    leaver = participant.another().enrol("leaver").begin()
    for each in (participant, leaver):
        each.take_trial()
        each.take_trial()
    (tmp_path / "before").mkdir()
    (tmp_path / "meanwhile").mkdir()
    before = reader(StudyFolder(tiny_study), tmp_path / "before")
    with leaving_at_first_sight(leaver) as left:
        assert reader(StudyFolder(tiny_study), tmp_path / "meanwhile") == before
    assert left


@contextmanager
def leaving_at_first_sight(leaver: Participant) -> Iterator[list[str]]:
    """Let a participant withdraw right after study sessions were first read."""
    left: list[str] = []

    def leave(_connection: Any, _cursor: Any, statement: str, *_rest: Any) -> None:
        if not left and StudySession.__tablename__ in statement:
            left.append(leaver.token)
            leaver.withdraw()

    event.listen(Engine, "after_cursor_execute", leave)
    try:
        yield left
    finally:
        event.remove(Engine, "after_cursor_execute", leave)
