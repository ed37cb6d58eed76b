from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.services.database import sqlite_url
from studyapp.web.app import create_app, database_url_of

ELSEWHERE = "postgresql://host/study"


@pytest.mark.parametrize(
    ("environment", "given", "rehearsal", "expected"),
    [
        (None, None, False, "responses.db"),
        (None, None, True, "rehearsal.db"),
        (ELSEWHERE, None, False, ELSEWHERE),
        (ELSEWHERE, None, True, "rehearsal.db"),
        (ELSEWHERE, "sqlite:////given.db", False, "sqlite:////given.db"),
        ("", None, False, "responses.db"),
    ],
)
def test_a_rehearsal_never_answers_into_the_real_database(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    environment: str | None,
    given: str | None,
    rehearsal: bool,
    expected: str,
) -> None:
    monkeypatch.delenv("DATABASE_URL", raising=False)
    if environment is not None:
        monkeypatch.setenv("DATABASE_URL", environment)

    url = database_url_of(tmp_path, database_url=given, rehearsal=rehearsal)

    assert url == (expected if ":" in expected else sqlite_url(tmp_path / expected))


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_a_clock_that_does_not_run_is_refused(tiny_study: Path, speed: float) -> None:
    with pytest.raises(InputError, match="speed"):
        create_app(tiny_study, rehearsal_speed=speed)
    assert not (tiny_study / "rehearsal.db").exists()


def test_a_study_that_cannot_be_served_leaves_no_database(tiny_study: Path) -> None:
    (tiny_study / "stimuli.json").write_text("{", "utf-8")

    with pytest.raises(InputError, match=r"stimuli\.json"):
        create_app(tiny_study)
    assert not (tiny_study / "responses.db").exists()
