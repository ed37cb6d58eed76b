"""What is made and paid on Mechanical Turk for a study."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import boto3
import pytest
from botocore.stub import Stubber

from motion.errors import InputError
from studyapp.database.engine import Database, database_url_of
from studyapp.recruitment import mturk
from studyapp.recruitment.mturk_client import SANDBOX, MTurkClient
from studyapp.session.arrival.enrolment import Arrival, enrol
from studyapp.session.served_study import ServedStudy
from studyapp.session.versions import open_study
from studyapp.study.folder import StudyFolder
from tests.studyapp.taking_part_steps import Participant, SetClock

ADDRESS = "https://study.example.org/"


@dataclass
class Sandbox:
    """Answers that Mechanical Turk gives in turn."""

    folder: StudyFolder
    stub: Stubber
    client: MTurkClient

    def hands_in(self, *assignments: tuple[str, str, str]) -> None:
        found = [
            {
                "AssignmentId": assignment,
                "WorkerId": worker,
                "AssignmentStatus": status,
                "Answer": "",
            }
            for assignment, worker, status in assignments
        ]
        self.stub.add_response("list_assignments_for_hit", {"Assignments": found})


@pytest.fixture
def tiny_study(tiny_study: Path, empty_sqlite: Path) -> Path:
    """Return the study with an empty database of the newest schema: making one takes longer."""
    shutil.copyfile(empty_sqlite, tiny_study / "responses.db")
    return tiny_study


@pytest.fixture
def sandbox(tiny_study: Path) -> Any:
    path = tiny_study / "study.toml"
    more = '[recruitment]\nchannel = "mturk"\n[recruitment.mturk]\nreward = "2.50"\n'
    path.write_text(path.read_text("utf-8") + more, "utf-8")
    keys = {"aws_access_key_id": "k", "aws_secret_access_key": "s"}
    connection = boto3.client("mturk", region_name="us-east-1", endpoint_url=SANDBOX, **keys)
    with Stubber(connection) as stub:
        yield Sandbox(StudyFolder(tiny_study), stub, MTurkClient(connection))
        stub.assert_no_pending_responses()


def make_hit(sandbox: Sandbox, hit: str) -> None:
    sandbox.stub.add_response("create_hit", {"HIT": {"HITId": hit}})
    mturk.create(sandbox.folder, sandbox.client, ADDRESS, live=False)


def test_what_was_made_in_the_sandbox_is_not_on_the_live_site(sandbox: Sandbox) -> None:
    make_hit(sandbox, "h1")
    make_hit(sandbox, "h2")

    assert mturk.hits_of(sandbox.folder, live=False) == ("h1", "h2")
    with pytest.raises(InputError, match="no HIT on the live site"):
        mturk.hits_of(sandbox.folder, live=True)


def test_a_study_session_is_paid_once_however_often_it_is_handed_in(
    sandbox: Sandbox, clock: SetClock
) -> None:
    root = sandbox.folder.root
    study, database = ServedStudy.read(root), Database.open(database_url_of(root))
    try:
        open_study(database, study, clock)
        arrival = Arrival(recruiter_participant="w1", recruiter_session="a1")
        token = enrol(database, study, arrival, clock)
        Participant(database, study, clock, token).begin().take_all()
    finally:
        database.close()
    make_hit(sandbox, "h1")
    sandbox.hands_in(
        ("a1", "w1", "Submitted"),
        ("a2", "w1", "Submitted"),
        ("a3", "w2", "Submitted"),
        ("a4", "w3", "Approved"),
    )

    found = mturk.judged(sandbox.folder, sandbox.client, live=False)

    assert [(each.assignment.id, each.judged.verdict) for each in found] == [
        ("a1", "pay"),
        ("a2", "look"),
        ("a3", "look"),
        ("a4", "settled"),
    ]
    sandbox.stub.add_response("approve_assignment", {}, {"AssignmentId": "a1"})
    assert mturk.approve(sandbox.client, found) == 1
