from __future__ import annotations

from typing import Any

import pytest
from pydantic import ValidationError

from tests.studyapp.made_study import make_study

CODES = {"completed": "KX7QM2PWTR", "screened_out": "HB4NVJ9ZCD", "failed_attention": "WU3FGRE8KA"}


def problems(**recruitment: Any) -> str:
    with pytest.raises(ValidationError) as refused:
        make_study(recruitment=recruitment)
    return str(refused.value)


def test_a_study_is_open_by_link_and_pays_whoever_fails_fewer_than_two_checks() -> None:
    recruitment = make_study().recruitment

    assert recruitment.channel == "link"
    assert recruitment.unpaid_failed_checks == 2
    assert recruitment.missing_codes == []


def test_one_failed_check_costs_pay_in_short_studies_only() -> None:
    assert "no ground for refusing pay" in problems(unpaid_failed_checks=1)
    short = make_study(
        page={"consent": "You agree.", "minutes": 4}, recruitment={"unpaid_failed_checks": 1}
    )
    assert short.recruitment.outcome(1) == "failed_attention"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"completed": "DONE-ALL-99"}, "recruitment.prolific.completed: the code holds the word"),
        ({"screened_out": "kx7qm2pwtr"}, "two outcomes have the same code"),
        ({"screened_out_reward": 10}, "need each other"),
        ({"reward": 9, "screened_out_reward": 9, "screened_out_places": 5}, "less than reward"),
    ],
)
def test_what_cannot_be_right_for_prolific_is_said(changes: dict[str, Any], said: str) -> None:
    assert said in problems(channel="prolific", prolific=CODES | changes)


def test_a_study_may_wait_for_its_codes() -> None:
    study = make_study(recruitment={"channel": "prolific", "prolific": {"completed": "KX7QM2PWTR"}})

    assert study.recruitment.missing_codes == ["screened_out", "failed_attention"]
