"""Prolific's API over HTTP, and the draft of a study there."""

import logging
from collections.abc import Iterator
from typing import Any
from wsgiref.types import StartResponse, WSGIEnvironment

import pytest
from flask import Flask, request
from flask.typing import ResponseReturnValue

from motion.errors import InputError
from studyapp.recruitment.prolific import prolific_draft
from studyapp.recruitment.prolific_client import (
    PAGE_SIZE,
    TRIES,
    ProlificClient,
    ProlificRefusedError,
    prolific_token,
)
from tests.studyapp.recruitment.prolific_stand_in import TOKEN, StandIn, served
from tests.support.servers.local_server import listening
from tests.support.studies.made_study import CODES, make_segments, make_study

PAGE = {"consent": "You agree.", "minutes": 10}
PROLIFIC = CODES | {"reward": 200}


def draft(address: str = "https://study.example.org/", **changes: Any) -> dict[str, Any]:
    recruitment = {"channel": "prolific", "prolific": PROLIFIC | changes}
    study = make_study(page=PAGE, recruitment=recruitment)
    return prolific_draft(study, make_segments(["happiness"] * 4), address)


@pytest.fixture
def stand_in() -> Iterator[StandIn]:
    with served(StandIn()) as running:
        yield running


@pytest.fixture
def waits() -> list[float]:
    return []


@pytest.fixture
def client(stand_in: StandIn, waits: list[float]) -> Iterator[ProlificClient]:
    with ProlificClient(TOKEN, address=stand_in.address, wait=waits.append) as opened:
        yield opened


def test_a_lost_response_is_recovered_and_a_refusal_quotes_prolific(
    client: ProlificClient, stand_in: StandIn
) -> None:
    made = client.create(draft())
    with pytest.raises(ProlificRefusedError, match="PAUSE from UNPUBLISHED"):
        client.move(made.id, "PAUSE")

    stand_in.lost_answers = [502]
    assert client.move(made.id, "PUBLISH").status == "ACTIVE"


def test_a_draft_whose_response_was_lost_is_not_created_twice(
    client: ProlificClient, stand_in: StandIn, waits: list[float]
) -> None:
    wanted = draft()
    stand_in.lost_answers = [502]

    with pytest.raises(InputError, match=r"502\).* may have been done"):
        client.create(wanted)

    assert (len(stand_in.studies), waits) == (1, [])
    found = client.study_named(wanted["internal_name"])
    assert found is not None
    assert found.id in stand_in.studies
    assert client.study_named("another") is None


def test_a_busy_prolific_is_retried_with_growing_pauses(
    client: ProlificClient, stand_in: StandIn, waits: list[float]
) -> None:
    stand_in.troubles = [429, 429, 503]
    with pytest.raises(InputError, match="503"):  # 503 leaves open whether the draft was made
        client.create(draft())
    assert waits == [1.0, 2.0]

    stand_in.troubles = [503, 429]
    assert client.study_named("nothing") is None
    assert waits[2:] == [1.0, 2.0]
    stand_in.troubles, stand_in.retry_after = [429], "17"
    assert client.study_named("nothing") is None
    assert waits[4:] == [17.0]

    stand_in.troubles = [500] * 9
    absent = ProlificClient(TOKEN, address="http://127.0.0.1:9", wait=waits.append)
    with listening(garbled) as address:
        unread = ProlificClient(TOKEN, address=address, wait=waits.append)
        for asked, why in (
            (client, "status 500"),
            (absent, "ConnectError"),
            (unread, "DecodingError"),
        ):
            waits.clear()
            with asked, pytest.raises(InputError, match=rf"cannot be reached \({why}\)"):
                asked.study("x")
            assert len(waits) == TRIES - 1


def garbled(_environ: WSGIEnvironment, start_response: StartResponse) -> list[bytes]:
    """Answer in an encoding that it does not keep."""
    start_response("200 OK", [("Content-Encoding", "gzip")])
    return [b"no gzip"]


@pytest.mark.parametrize("listed_twice", [0, 1])
def test_all_pages_of_submissions_are_read_and_many_are_approved_in_few_requests(
    client: ProlificClient, stand_in: StandIn, listed_twice: int
) -> None:
    made = client.create(draft())
    everybody = [f"p{number}" for number in range(2 * PAGE_SIZE)]
    for name in everybody:
        stand_in.add_submission(name, "AWAITING REVIEW", "KX7QM2PWTR")
    stand_in.submissions.extend(map(dict, stand_in.submissions[-listed_twice:] * listed_twice))

    submissions = client.submissions(made.id)
    client.approve([each.id for each in submissions[:120]])
    client.approve([])

    assert [(each.participant, each.code) for each in submissions] == [
        (name, "KX7QM2PWTR") for name in everybody
    ]
    assert [each["status"] for each in stand_in.submissions].count("APPROVED") == 120
    assert len([each for each in stand_in.asked if "bulk-approve" in each]) == 2


@pytest.mark.parametrize(("status", "words"), [(400, "answered 400: Token …"), (401, "not accept")])
def test_the_token_is_in_no_error_log_or_address_and_not_in_what_echoes_it(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch, status: int, words: str
) -> None:
    asked, app = [], Flask(__name__)

    @app.route("/<path:_path>")
    def echo(_path: str) -> ResponseReturnValue:
        asked.append(request.url)
        return {"error": {"detail": request.headers["Authorization"]}}, status

    with (
        listening(app.wsgi_app) as address,
        caplog.at_level(logging.DEBUG),
        ProlificClient(TOKEN, address=address) as client,
        pytest.raises(InputError, match=words) as refused,
    ):
        client.study("x")
    assert asked
    assert TOKEN not in str(refused.value) + caplog.text + "".join(asked)
    for held, message in (("  ", "is not set"), (f"two\n{TOKEN}", "holds no Prolific token")):
        monkeypatch.setenv("PROLIFIC_TOKEN", held)
        with pytest.raises(InputError, match=message) as unread:
            prolific_token()
        assert TOKEN not in str(unread.value)


def actions(sent: dict[str, Any], outcome: str) -> tuple[str, list[dict[str, Any]]]:
    found = next(each for each in sent["completion_codes"] if each["code"] == PROLIFIC[outcome])
    return found["code_type"], found["actions"]


def test_each_outcome_has_its_code_and_only_finishing_may_be_paid_unseen() -> None:
    review = [{"action": "MANUALLY_REVIEW"}]

    assert actions(draft(), "completed") == ("COMPLETED", review)
    assert actions(draft(), "failed_attention") == ("FAILED_ATTENTION_CHECK", review)
    assert actions(draft(), "screened_out")[1][0]["action"] == "REQUEST_RETURN"
    at_once = draft(automatic=True)
    assert actions(at_once, "completed")[1] == [{"action": "AUTOMATICALLY_APPROVE"}]
    assert actions(at_once, "failed_attention")[1] == review


def test_prolifics_address_has_a_placeholder_for_the_participant() -> None:
    sent = draft()

    assert sent["external_study_url"] == (
        "https://study.example.org/?PROLIFIC_PID={{%PROLIFIC_PID%}}&STUDY_ID={{%STUDY_ID%}}"
        "&SESSION_ID={{%SESSION_ID%}}"
    )
    assert sent["total_available_places"] == 50  # two comparisons of 25
    assert sent["peripheral_requirements"] == ["audio"]
    assert sent["device_compatibility"] == ["desktop", "tablet"]
    assert "is_external_study_url_secure" not in sent
    assert draft(signed_for="study.example.org")["is_external_study_url_secure"] is True
    # Two studies of one name are distinguished by their codes.
    names = {sent["internal_name"], draft(completed="ZR5WQ8HXKM")["internal_name"]}
    assert len(names) == 2
    assert not any(PROLIFIC["completed"] in name for name in names)


def test_missing_settings_and_unacceptable_addresses_are_refused() -> None:
    study = make_study(recruitment={"channel": "prolific"})
    with pytest.raises(InputError) as refused:
        prolific_draft(study, (), "https://study.example.org/")
    for key in ("completed", "screened_out", "failed_attention", "reward", "page.minutes"):
        assert key in str(refused.value)

    for address in ("http://study.example.org/", "https://x.org/?a=1", "x.org"):
        with pytest.raises(InputError, match="https://"):
            draft(address)
