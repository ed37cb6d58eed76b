"""Studies are restored from backups completely, or not at all."""

import shutil
import stat
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from time import sleep

import pytest
from sqlalchemy import select

from motion.errors import InputError
from studyapp.custody import backup, restoration
from studyapp.custody.backup import Backup, back_up
from studyapp.custody.restoration import restore
from studyapp.database.copies import require_empty
from studyapp.database.engine import Database, sqlite_url
from studyapp.database.tables.researchers import AuditLine
from studyapp.database.tables.study_session import StudySession
from studyapp.database.tables.trial import Trial
from studyapp.researchers.pseudonyms import PseudonymKey
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from tests.support.servers.both_databases import BOTH
from tests.support.studies.stored import everything_stored, opened
from tests.support.studies.taking_part_steps import Participant, SetClock, taking_part

PEOPLE = ("visit-of-one", "visit-of-two")


@dataclass
class Study:
    """A study in which two people have answered two trials each."""

    folder: StudyFolder
    people: list[Participant]
    clock: SetClock
    backups: Path

    def back_up(self, name: str = "out.zip", *, media: bool = False) -> Backup:
        self.clock.advance(minutes=1)
        return back_up(self.folder, self.backups / name, self.clock, media=media)


@pytest.fixture
def study(tiny_study: Path, tmp_path: Path) -> Iterator[Study]:
    folder, backups = StudyFolder(tiny_study), tmp_path / "backups"
    PseudonymKey.read_or_make(folder.pseudonym_key)
    backups.mkdir()
    with taking_part(tiny_study) as first:
        people = [first.another().enrol(name).begin() for name in PEOPLE]
        for each in people:
            each.take_trial()
            each.take_trial()
        yield Study(folder, people, first.clock, backups)


@pytest.fixture
def new(tmp_path: Path) -> StudyFolder:
    """Return the folder to which a study is restored."""
    return StudyFolder(tmp_path / "new")


def contents(root: Path) -> dict[str, bytes]:
    return {
        path.relative_to(root).as_posix(): path.read_bytes()
        for path in root.rglob("*")
        if path.is_file() and not path.name.startswith("responses.db")
    }


def test_everything_is_restored_and_participants_can_continue(
    study: Study, new: StudyFolder
) -> None:
    made = study.back_up(media=True)

    restore(made.path, new, study.clock)

    for_the_owner = (made.path, new.pseudonym_key, new.responses)
    assert {stat.S_IMODE(path.stat().st_mode) for path in for_the_owner} == {0o600}
    assert list(study.backups.iterdir()) == [made.path]
    assert contents(new.root) == contents(study.folder.root)
    with opened(new.responses) as database, database.reading() as session:
        one = Participant(database, ServedStudy.read(new.root), study.clock, study.people[0].token)
        assert one.trial().position == 3
        assert one.take_all()
        (line,) = session.scalars(select(AuditLine))
        moment = f"{made.manifest.made_at:%Y-%m-%d %H:%M:%S} UTC"
        assert (line.event, line.detail) == ("restored", f"as it was on {moment}")


def test_nothing_is_overwritten_or_written_elsewhere(
    study: Study, new: StudyFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = study.back_up()
    before = made.path.read_bytes()
    for name in ("out.tar", "out", "nowhere/out.zip", "out.zip"):
        with pytest.raises(InputError, match=r"does not exist|a backup is a|never overwrite"):
            study.back_up(name)
    assert list(study.backups.iterdir()) == [made.path]
    (tmp_path / "elsewhere.db").write_bytes(b"")
    with monkeypatch.context() as patch:
        patch.setenv("DATABASE_URL", sqlite_url(tmp_path / "elsewhere.db"))
        with pytest.raises(InputError, match="the database is not empty"):
            restore(made.path, new, study.clock)
    assert not new.root.exists()
    with pytest.raises(InputError, match=r"it contains pseudonyms\.key"):
        restore(made.path, study.folder, study.clock)
    restore(made.path, new, study.clock)
    with pytest.raises(InputError, match="the folder is not empty"):
        restore(made.path, new, study.clock)
    assert made.path.read_bytes() == before


def fail(*_: object, **__: object) -> None:
    raise OSError(28, "No space left on device")


@pytest.mark.parametrize("step", ["display_address", "compact", "require_intact", "_note_restored"])
def test_a_failed_restore_leaves_nothing_or_everything(
    study: Study, new: StudyFolder, step: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = study.back_up()
    monkeypatch.setattr(restoration, step, fail)

    with pytest.raises(OSError, match="No space"):
        restore(made.path, new, study.clock)

    assert new.definition.exists() == new.responses.exists() == (step == "display_address")
    assert new.root.exists() == (step == "display_address")


def test_a_full_disk_leaves_no_half_backup(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(backup, "write_archive", fail)

    with pytest.raises(OSError, match="No space left on device"):
        study.back_up()

    assert list(study.backups.iterdir()) == []


def test_a_folder_keeps_only_the_newest_backups_of_a_study(study: Study, tmp_path: Path) -> None:
    another = shutil.copytree(study.folder.root, tmp_path / "elsewhere" / "study")
    other = back_up(StudyFolder(another), study.backups, study.clock)
    (study.backups / "study-20200101T000000Z.zip").write_bytes(b"not made by this command")
    by_hand = study.back_up("by-hand.zip")
    made = []
    for _ in range(4):
        study.clock.advance(minutes=1)
        made.append(back_up(study.folder, study.backups, study.clock, keep=2))

    assert made[-1].removed == (made[1].path,)
    assert {path.name for path in study.backups.iterdir()} == {
        "study-20200101T000000Z.zip",
        *(each.path.name for each in (other, by_hand, *made[2:])),
    }

    study.clock.advance(hours=-1)
    after_a_wrong_clock = back_up(study.folder, study.backups, study.clock, keep=2)

    assert after_a_wrong_clock.removed == (made[2].path,)
    with pytest.raises(InputError, match="only be removed from a folder"):
        back_up(study.folder, study.backups / "x.zip", study.clock, keep=2)


def stored(folder: StudyFolder) -> dict[str, str]:
    with opened(folder.responses) as database:
        return everything_stored(database)


on_postgresql = pytest.mark.parametrize("empty_url", ["postgresql"], indirect=True)


@on_postgresql
def test_a_study_moves_from_sqlite_to_postgresql_and_back(
    study: Study, new: StudyFolder, tmp_path: Path, empty_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = study.back_up(media=True)
    monkeypatch.setenv("DATABASE_URL", empty_url)
    password = empty_url.split(":")[2].split("@")[0]

    _, address = restore(made.path, new, study.clock)
    again = back_up(new, study.backups / "again.zip", study.clock, media=True)
    with pytest.raises(InputError, match="the database is not empty"):
        restore(made.path, StudyFolder(tmp_path / "third"), study.clock)
    monkeypatch.delenv("DATABASE_URL")
    restore(again.path, StudyFolder(tmp_path / "back"), study.clock)

    assert address.startswith("postgresql")
    assert not new.responses.exists()
    before, after = stored(study.folder), stored(StudyFolder(tmp_path / "back"))
    assert {table for table in before if after[table] != before[table]} == {"audit_lines"}
    assert again.manifest.rows == made.manifest.rows | {"audit_lines": 1}
    for text in (address, again.database, again.path.read_bytes().decode("latin-1")):
        assert password not in text


@on_postgresql
def test_postgresql_stays_empty_if_files_cannot_be_moved(
    study: Study, new: StudyFolder, empty_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = study.back_up()
    monkeypatch.setenv("DATABASE_URL", empty_url)
    monkeypatch.setattr(shutil, "move", fail)

    with pytest.raises(OSError, match="No space"):
        restore(made.path, new, study.clock)

    require_empty(empty_url)
    assert not new.root.exists()


def test_a_backup_that_names_files_outside_the_study_is_refused(
    study: Study, new: StudyFolder
) -> None:
    listed = study.folder.stimuli.read_text("utf-8")
    study.folder.stimuli.write_text(listed.replace("videos/pairs/000", "../secret"), "utf-8")
    made = study.back_up()

    with pytest.raises(InputError, match=r"'\.\./secret\.mp4' lies outside"):
        restore(made.path, new, study.clock)
    assert not new.root.exists()


@BOTH
def test_a_backup_while_people_answer_has_every_acknowledged_answer_and_interrupts_nobody(
    tiny_study: Path, tmp_path: Path, database_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("DATABASE_URL", database_url)
    served, acknowledged, is_backed_up = ServedStudy.read(tiny_study), list[str](), Event()

    def take_part(number: int) -> None:
        participant = Participant(database, served, SetClock()).enrol(f"{number}").begin()
        assert number or is_backed_up.wait(60)
        while participant.look().trial is not None:
            acknowledged.append(participant.take_trial())

    with closing(Database.open(database_url)) as database, ThreadPoolExecutor(4) as pool:
        open_study(database, served, SetClock())
        people = [pool.submit(take_part, number) for number in range(4)]
        while len(acknowledged) < 4 and not any(each.done() for each in people):
            sleep(0.001)
        before = set(acknowledged)
        made = back_up(StudyFolder(tiny_study), tmp_path / "out.zip", SetClock(), media=True)
        is_backed_up.set()
        for each in people:
            each.result()

    monkeypatch.delenv("DATABASE_URL")
    copy, later = StudyFolder(tmp_path / "copy"), SetClock()
    later.advance(hours=1)
    restore(made.path, copy, later)
    with opened(copy.responses) as database:
        with database.reading() as session:
            answered = select(Trial).where(Trial.answered_at.is_not(None))
            restored = {trial.token: len(trial.responses) for trial in session.scalars(answered)}
            sessions = session.scalars(select(StudySession)).all()
        assert made.manifest.participants == len(sessions)
        assert before <= restored.keys() < set(acknowledged)
        assert set(restored.values()) == {2}
        for unfinished in (each for each in sessions if each.completed_at is None):
            assert Participant(database, served, later, unfinished.token).take_all()


def test_links_to_media_are_followed_without_loops(study: Study, tmp_path: Path) -> None:
    shutil.move(study.folder.videos, tmp_path / "big-disk")
    study.folder.videos.symlink_to(tmp_path / "big-disk")
    (tmp_path / "big-disk" / "circle").symlink_to(study.folder.root)

    paths = {file.path for file in study.back_up(media=True).manifest.files}

    assert "videos/pairs/000.mp4" in paths
    assert not [path for path in paths if "circle/videos" in path]
