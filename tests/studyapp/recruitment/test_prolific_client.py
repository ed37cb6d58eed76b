"""Prolific's API over HTTP, and the draft of a study there."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any

import httpx
import pytest

from motion.errors import InputError
from studyapp.recruitment.prolific import internal_name, prolific_draft
from studyapp.recruitment.prolific_client import (
    PAGE_SIZE,
    TRIES,
    ProlificClient,
    ProlificRefusedError,
    prolific_token,
)
from tests.studyapp.recruitment.prolific_stand_in import TOKEN, StandIn, served
from tests.support.studies.made_study import make_segments, make_study

PAGE = {"consent": "You agree.", "minutes": 10}
PROLIFIC = {
    "completed": "KX7QM2PWTR",
    "screened_out": "HB4NVJ9ZCD",
    "failed_attention": "WU3FGRE8KA",
    "reward": 200,
}


def draft(**changes: Any) -> dict[str, Any]:
    recruitment = {"channel": "prolific", "prolific": PROLIFIC | changes}
    study = make_study(page=PAGE, recruitment=recruitment)
    return prolific_draft(study, make_segments(["happiness"] * 4), "https://study.example.org/")


class Waits(list[float]):
    def __call__(self, seconds: float) -> None:
        self.append(seconds)


@pytest.fixture
def stand_in() -> Iterator[StandIn]:
    with served(StandIn()) as running:
        yield running


@pytest.fixture
def waits() -> Waits:
    return Waits()


@pytest.fixture
def client(stand_in: StandIn, waits: Waits) -> Any:
    with ProlificClient(TOKEN, address=stand_in.address, wait=waits) as opened:
        yield opened


def test_what_cannot_be_done_is_said_in_prolifics_words(client: ProlificClient) -> None:
    made = client.create(draft())

    with pytest.raises(ProlificRefusedError, match="PAUSE from UNPUBLISHED"):
        client.move(made.id, "PAUSE")


def test_an_action_whose_answer_was_lost_is_found_done(
    client: ProlificClient, stand_in: StandIn
) -> None:
    made = client.create(draft())
    stand_in.lost_answers = [502]

    assert client.move(made.id, "PUBLISH").status == "ACTIVE"


def test_a_draft_whose_answer_was_lost_is_not_made_again(
    client: ProlificClient, stand_in: StandIn, waits: Waits
) -> None:
    wanted = draft()
    stand_in.lost_answers = [502]

    with pytest.raises(InputError, match=r"502\).* may have been done"):
        client.create(wanted)

    assert len(stand_in.studies) == 1
    assert waits == []
    found = client.study_named(wanted["internal_name"])
    assert found is not None
    assert found.id in stand_in.studies
    assert client.study_named("another") is None


def test_a_busy_prolific_is_asked_again_later_and_later(
    client: ProlificClient, stand_in: StandIn, waits: Waits
) -> None:
    stand_in.troubles = [429, 429, 503]
    made = None

    with pytest.raises(InputError, match="503"):  # 503 leaves open whether the draft was made
        made = client.create(draft())
    assert made is None
    assert waits == [1.0, 2.0]

    stand_in.troubles = [503, 429]
    assert client.study_named("nothing") is None
    assert waits[2:] == [1.0, 2.0]
    stand_in.troubles, stand_in.retry_after = [429], "17"
    assert client.study_named("nothing") is None
    assert waits[4:] == [17.0]


def test_it_gives_up_in_words(client: ProlificClient, stand_in: StandIn, waits: Waits) -> None:
    stand_in.troubles = [500] * 9
    absent = ProlificClient(TOKEN, address="http://127.0.0.1:9", wait=waits)

    for asked, why in ((client, "status 500"), (absent, "ConnectError")):
        waits.clear()
        with asked, pytest.raises(InputError, match=rf"cannot be reached \({why}\)"):
            asked.study("x")
        assert len(waits) == TRIES - 1


def test_all_pages_of_submissions_are_read(client: ProlificClient, stand_in: StandIn) -> None:
    made = client.create(draft())
    for number in range(2 * PAGE_SIZE + 1):
        stand_in.add_submission(f"p{number}", "AWAITING REVIEW", "KX7QM2PWTR")

    found = client.submissions(made.id)

    assert [each.participant for each in found] == [f"p{n}" for n in range(2 * PAGE_SIZE + 1)]
    assert {each.code for each in found} == {"KX7QM2PWTR"}


def test_many_are_approved_in_few_requests(client: ProlificClient, stand_in: StandIn) -> None:
    client.create(draft())
    for number in range(150):
        stand_in.add_submission(f"p{number}", "AWAITING REVIEW", "KX7QM2PWTR")

    client.approve([each["id"] for each in stand_in.submissions[:120]])
    client.approve([])

    assert [each["status"] for each in stand_in.submissions].count("APPROVED") == 120
    assert len([each for each in stand_in.asked if "bulk-approve" in each]) == 2


def test_the_token_stands_in_no_error_log_or_address(
    stand_in: StandIn, waits: Waits, caplog: pytest.LogCaptureFixture
) -> None:
    secret = "s3cret-of-a-researcher"  # noqa: S105
    with (
        caplog.at_level(logging.DEBUG),
        ProlificClient(secret, address=stand_in.address, wait=waits) as client,
        pytest.raises(InputError, match="PROLIFIC_TOKEN") as refused,
    ):
        client.study("x")

    assert secret not in str(refused.value)
    assert secret not in caplog.text
    assert not any(secret in each for each in stand_in.asked)


def test_an_answer_that_repeats_the_token_does_not_bring_it_into_the_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def echo(request: httpx.Request) -> httpx.Response:
        return httpx.Response(400, json={"error": {"detail": request.headers["Authorization"]}})

    with ProlificClient(TOKEN) as client:
        client._client = httpx.Client(
            base_url="http://x",
            headers={"Authorization": f"Token {TOKEN}"},
            transport=httpx.MockTransport(echo),
        )
        with pytest.raises(ProlificRefusedError) as refused:
            client.study("x")

    assert TOKEN not in str(refused.value)


def test_an_unusable_token_is_refused_without_being_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    for held, message in (("  ", "is not set"), ("two\nlines-of-token", "holds no token")):
        monkeypatch.setenv("PROLIFIC_TOKEN", held)
        with pytest.raises(InputError, match=message) as refused:
            prolific_token()
        assert "lines" not in str(refused.value)


SEGMENTS = make_segments(["happiness"] * 4)


def actions(sent: dict[str, Any], outcome: str) -> tuple[str, list[dict[str, Any]]]:
    found = next(each for each in sent["completion_codes"] if each["code"] == PROLIFIC[outcome])
    return found["code_type"], found["actions"]


def test_each_outcome_has_its_code_and_only_finishing_may_be_paid_unseen() -> None:
    sent = draft()

    assert actions(sent, "completed") == ("COMPLETED", [{"action": "MANUALLY_REVIEW"}])
    kind, reviewed = actions(sent, "failed_attention")
    assert (kind, reviewed) == ("FAILED_ATTENTION_CHECK", [{"action": "MANUALLY_REVIEW"}])
    assert actions(sent, "screened_out")[1][0]["action"] == "REQUEST_RETURN"
    at_once = draft(automatic=True)
    assert actions(at_once, "completed")[1] == [{"action": "AUTOMATICALLY_APPROVE"}]
    assert actions(at_once, "failed_attention")[1] == [{"action": "MANUALLY_REVIEW"}]


def test_who_is_screened_out_can_be_paid_a_fixed_sum() -> None:
    kind, done = actions(draft(screened_out_reward=15, screened_out_places=40), "screened_out")

    assert kind == "FIXED_SCREENOUT"
    assert done == [
        {"action": "FIXED_SCREEN_OUT_PAYMENT", "fixed_screen_out_reward": 15, "slots": 40}
    ]


def test_prolific_is_told_to_name_the_participant_in_the_address() -> None:
    sent = draft()

    assert sent["external_study_url"] == (
        "https://study.example.org/?PROLIFIC_PID={{%PROLIFIC_PID%}}&STUDY_ID={{%STUDY_ID%}}"
        "&SESSION_ID={{%SESSION_ID%}}"
    )
    assert sent["total_available_places"] == 50  # two comparisons of 25
    assert draft(places=7)["total_available_places"] == 7
    assert sent["peripheral_requirements"] == ["audio"]
    assert sent["device_compatibility"] == ["desktop", "tablet"]


def test_prolific_signs_who_comes_only_where_it_is_asked_to() -> None:
    assert draft(signed_for="study.example.org")["is_external_study_url_secure"] is True
    assert "is_external_study_url_secure" not in draft()


def test_two_studies_of_one_name_are_told_apart_by_their_codes() -> None:
    names = {draft()["internal_name"], draft(completed="ZR5WQ8HXKM")["internal_name"]}

    assert len(names) == 2
    assert not any(PROLIFIC["completed"] in name for name in names)


def test_what_is_missing_is_named() -> None:
    study = make_study(recruitment={"channel": "prolific"})

    with pytest.raises(InputError) as refused:
        prolific_draft(study, SEGMENTS, "https://study.example.org/")

    for key in ("completed", "screened_out", "failed_attention", "reward", "page.minutes"):
        assert key in str(refused.value)


@pytest.mark.parametrize("address", ["http://study.example.org/", "https://x.org/?a=1", "x.org"])
def test_an_address_that_no_recruiter_accepts_is_refused(address: str) -> None:
    study = make_study(page=PAGE, recruitment={"channel": "prolific", "prolific": PROLIFIC})

    with pytest.raises(InputError, match="https://"):
        prolific_draft(study, SEGMENTS, address)
    assert internal_name(study).startswith("motionjury made ")
