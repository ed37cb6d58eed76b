from __future__ import annotations

from typing import Any

import pytest

from motion.errors import InputError
from studyapp.recruitment.prolific import internal_name, prolific_draft
from tests.studyapp.recruitment.test_prolific_client import PAGE, PROLIFIC, draft
from tests.support.studies.made_study import make_segments, make_study

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
