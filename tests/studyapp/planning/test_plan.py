from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.planning.plan import read_pilot
from tests.studyapp.conftest import OwnStudy
from tests.support.studies.answered_study import answer_study
from tests.support.studies.redefining import redefine


@pytest.fixture
def pairwise(own_study: OwnStudy, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    return own_study("pairwise").root


def test_an_answered_study_gives_spreads_and_its_exclusion_rate(pairwise: Path) -> None:
    redefine(pairwise, ("participants = 3", "participants = 16"))
    answer_study(pairwise, people=16, stop_after=2)

    result = read_pilot(pairwise, "pairwise")

    assert 0 < result.excluded < 1
    assert result.opinions.participant_sd >= 0
    assert 0 < result.opinions.slight <= result.opinions.clear
    assert "Estimated from" in result.source
    assert "pairwise" in result.source
    assert "its spreads are rough" in result.notes[0]


def test_a_study_without_answers_reports_nothing(pairwise: Path) -> None:
    with pytest.raises(InputError, match="no answers to a pairwise task"):
        read_pilot(pairwise, "pairwise")


def test_a_pilot_of_another_protocol_is_refused(pairwise: Path) -> None:
    with pytest.raises(InputError, match="a pairwise study, and a rating study is planned"):
        read_pilot(pairwise, "rating")
