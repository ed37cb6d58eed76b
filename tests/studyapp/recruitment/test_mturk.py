"""Mechanical Turk, as boto3 describes it; and what a study makes and pays there."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import boto3
import pytest
from botocore.stub import Stubber

from motion.errors import InputError
from studyapp.recruitment import mturk
from studyapp.recruitment.mturk import (
    LIVE,
    LONG_AGO,
    SANDBOX,
    SCHEMA,
    MTurkClient,
    connect,
    hit_request,
)
from studyapp.session.enrolment import Arrival
from studyapp.study.folder import StudyFolder
from tests.support.command_line import run
from tests.support.studies.made_study import make_study
from tests.support.studies.redefining import redefine
from tests.support.studies.taking_part_steps import taking_part

ADDRESS = "https://study.example.org/a&b/"
STUDY = make_study(
    page={"consent": "You agree.", "minutes": 10},
    recruitment={"channel": "mturk", "mturk": {"reward": "3.50"}},
)


@pytest.fixture
def connection(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.setenv("AWS_EC2_METADATA_DISABLED", "true")
    keys = {"aws_access_key_id": "k", "aws_secret_access_key": "s"}
    return boto3.client("mturk", region_name="us-east-1", endpoint_url=SANDBOX, **keys)


@pytest.fixture
def stub(connection: Any) -> Iterator[Stubber]:
    with Stubber(connection) as active:
        yield active
        active.assert_no_pending_responses()


@pytest.fixture
def client(connection: Any) -> MTurkClient:
    return MTurkClient(connection)


def test_a_hit_is_created_inspected_and_stopped(client: MTurkClient, stub: Stubber) -> None:
    request = hit_request(STUDY, ADDRESS, made_before=0, live=False)
    answer = {"HIT": {"HITId": "h1", "HITStatus": "Assignable", "MaxAssignments": 20}}
    stub.add_response("create_hit", answer, request)
    known = {"HITId": "h1", "HITStatus": "Assignable", "NumberOfAssignmentsPending": 3}
    stub.add_response("get_hit", {"HIT": known}, {"HITId": "h1"})
    stub.add_response("update_expiration_for_hit", {}, {"HITId": "h1", "ExpireAt": LONG_AGO})

    assert client.create(request).wanted == 20
    assert client.hit("h1").pending == 3
    client.stop("h1")

    question = ElementTree.fromstring(request["Question"])  # noqa: S314 - our own
    assert question.tag == f"{{{SCHEMA}}}ExternalQuestion"
    assert [each.text for each in question] == [ADDRESS, "0"]
    # The same HIT is requested by the same token, so that a day's repetition makes no second one.
    assert request == hit_request(STUDY, ADDRESS, made_before=0, live=False)
    tokens = {
        hit_request(STUDY, ADDRESS, made_before=made, live=live)["UniqueRequestToken"]
        for made, live in ((0, False), (1, False), (0, True))
    }
    assert len(tokens) == 3
    with pytest.raises(InputError, match="reward"):
        hit_request(make_study(), ADDRESS, made_before=0, live=False)


def test_the_sandbox_is_used_unless_the_live_site_is_requested(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []
    monkeypatch.setattr(boto3, "client", lambda name, **options: asked.append((name, options)))

    connect(live=False)
    connect(live=True)

    assert [name for name, _ in asked] == ["mturk", "mturk"]
    assert [options["endpoint_url"] for _, options in asked] == [SANDBOX, LIVE]


def test_a_study_session_is_paid_once_however_often_it_is_submitted_and_in_the_sandbox_alone(
    tiny_study: Path, stub: Stubber, client: MTurkClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    more = '[recruitment]\nchannel = "mturk"\n[recruitment.mturk]\nreward = "2.50"\n'
    redefine(tiny_study, added=more)
    monkeypatch.setattr(mturk, "connect", lambda *, live: client)
    recruit = partial(run, "recruit", tiny_study)
    with taking_part(tiny_study) as worker:
        arrival = Arrival(recruiter_participant="w1", recruiter_session="a1")
        worker.arrive(arrival).begin().take_all()
    create = ("create", "--address", ADDRESS)
    assert "in the sandbox, where nobody is paid\nNothing was offered" in recruit(*create)
    stub.add_response("create_hit", {"HIT": {"HITId": "h1"}})
    assert "Created HIT h1" in recruit(*create, "--yes")
    with pytest.raises(InputError, match="no HIT on the live site"):
        mturk.hits_of(StudyFolder(tiny_study), live=True)
    assignments = [
        {"AssignmentId": f"a{number}", "WorkerId": worker, "AssignmentStatus": status}
        for number, (worker, status) in enumerate(
            [("w1", "Submitted"), ("w1", "Submitted"), ("w2", "Submitted"), ("w3", "Approved")], 1
        )
    ]
    stub.add_response("list_assignments_for_hit", {"Assignments": assignments})

    shown = recruit("approve")

    actions = {line[:2]: line.split()[1] for line in shown.splitlines()}
    assert [actions[f"a{number}"] for number in range(1, 5)] == ["pay", "your", "your", "–"]
    assert "1 to pay, 2 for you to decide, 0 under way, 1 settled.\nNothing was paid" in shown
    stub.add_response("list_assignments_for_hit", {"Assignments": assignments})
    stub.add_response("approve_assignment", {}, {"AssignmentId": "a1"})
    assert "Approved 1 assignment." in recruit("approve", "--yes")
