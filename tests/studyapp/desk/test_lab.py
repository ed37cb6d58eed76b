"""What is served of a desk's studies follows their files."""

import shutil
import sqlite3
from contextlib import closing

import pytest

from studyapp.desk.lab import Lab, LabStudy
from studyapp.desk.server import raise_alarms_of_studies
from studyapp.monitoring.alarms import WEBHOOK, AlarmChannels
from studyapp.session.enrolment import add_newcomer
from studyapp.session.intake import change_intake
from tests.studyapp.desk.conftest import first_question
from tests.support.studies.redefining import redefine

AGAIN = ("fit the rhythm of the speech better", "follow the speech better")


def test_a_study_is_in_preparation_until_its_videos_exist(tiny: LabStudy) -> None:
    video = tiny.folder.videos / "pairs" / "003.mp4"
    away = tiny.folder.root / "003.mp4"
    video.rename(away)
    assert tiny.standing().state == "being made"
    assert tiny.application() is None
    away.rename(video)
    assert tiny.standing().state == "ready"
    assert tiny.application() is not None


def test_a_study_stands_as_its_recruitment_does(taken: LabStudy, lab: Lab) -> None:
    served = taken.served()
    assert served is not None
    standings = [taken.standing().state]
    for state in ("paused", "open", "closed"):
        change_intake(taken.database, served, lab.clock, state, by="Ada", reason="a test")
        standings.append(taken.standing().state)
    assert standings == ["running", "paused", "running", "closed"]


def test_each_studys_alarms_are_sent_even_if_another_study_is_damaged(
    lab: Lab, tiny: LabStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(tiny.folder.root, lab.folder / "damaged")
    with closing(sqlite3.connect(lab.folder / "damaged" / "responses.db")) as database:
        database.execute("DROP TABLE alarms")
    sent: list[str] = []

    def send(_channels: AlarmChannels, text: str) -> bool:
        sent.append(text)
        return True

    monkeypatch.setenv(WEBHOOK, "https://hooks.example.org/")
    monkeypatch.setattr(AlarmChannels, "send", send)
    with tiny.database.writing() as session:
        for _ in range(10):
            add_newcomer(session, "192.0.2.9", lab.clock.now())
    raise_alarms_of_studies(lab)
    assert len(sent) == 1
    assert "10 participants" in sent[0]


def test_a_change_before_the_first_participant_is_served_at_once(tiny: LabStudy) -> None:
    before = tiny.application()
    redefine(tiny.folder.root, AGAIN)
    assert first_question(tiny).endswith("follow the speech better?")
    assert tiny.application() is not before


def test_participants_continue_with_the_old_study_if_a_file_is_invalid(tiny: LabStudy) -> None:
    before = tiny.application()
    redefine(tiny.folder.root, ("trials = 4", "trails = 4"))
    assert tiny.application() is before
    standing = tiny.standing()
    assert standing.state == "ready"
    assert standing.problem is not None
    redefine(tiny.folder.root, ("trails = 4", "trials = 4"))
    assert tiny.standing().problem is None


def test_another_process_waits_for_a_new_version_and_then_serves_it(
    lab: Lab, taken: LabStudy
) -> None:
    other = LabStudy(taken.folder.root, lab.database, lab.clock, "")
    redefine(taken.folder.root, AGAIN)
    assert first_question(taken).endswith("rhythm of the speech better?")
    assert other.standing().state == "changed"
    assert other.application() is None
    taken.begin_new_version(by="Ada")
    for study in (taken, other):
        assert first_question(study).endswith("follow the speech better?")
        assert study.standing().problem is None


def test_only_folders_of_studies_with_plain_names_are_studies(lab: Lab, tiny: LabStudy) -> None:
    for name in ("research", "static", "with space", ".hidden", "dot.ted"):
        (lab.folder / name).mkdir()
        (lab.folder / name / "study.toml").write_bytes(tiny.folder.definition.read_bytes())
    (lab.folder / "empty").mkdir()
    assert [each.name for each in lab.studies()] == ["tiny"]
    assert lab.study("../lab/tiny") is None
