from __future__ import annotations

from pathlib import Path

import pytest

from motion.errors import InputError
from studyapp.web.app import create_app


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_a_clock_that_does_not_run_is_refused(tiny_study: Path, speed: float) -> None:
    with pytest.raises(InputError, match="speed"):
        create_app(tiny_study, rehearsal_speed=speed)
    assert not (tiny_study / "rehearsal.db").exists()


def test_a_study_that_cannot_be_served_leaves_no_database(tiny_study: Path) -> None:
    (tiny_study / "responses.db").unlink()
    (tiny_study / "stimuli.json").write_text("{", "utf-8")

    with pytest.raises(InputError, match=r"stimuli\.json"):
        create_app(tiny_study)
    assert not (tiny_study / "responses.db").exists()
