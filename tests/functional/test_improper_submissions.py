"""Every protocol's server refuses what no page offers, and stores nothing of it."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from sqlalchemy import select

from studyapp.database.tables import Trial
from studyapp.web.app import create_app
from studyapp.web.site import EXTENSION
from tests.functional.improper_submissions import Attacker
from tests.studyapp.rehearsal.protocol_studies import STUDIES, write_study
from tests.studyapp.rehearsal.steps import SPEED, browser, participant_of
from tests.support.studies.finished_study import write_short_video
from tests.support.studies.stored import opened

FORMS = {
    "no answer to the question 'adult'",
    "an answer that excludes to the question 'adult'",
    "an answer that excludes to the question 'watched'",
    "too high a number to the question 'age'",
    "too long an answer to the question 'work'",
    "an answer that is not offered to the question 'often'",
    "digits that were not spoken",
}
"""What every study's forms give an occasion for."""


@pytest.mark.parametrize("name", STUDIES)
def test_improper_submissions_are_refused_on_every_kind_of_page_and_change_nothing(
    name: str, tmp_path: Path
) -> None:
    write_short_video(tmp_path / "short.mp4", seconds=1.0)
    folder = write_study(tmp_path / "study", name, tmp_path / "short.mp4")
    app = create_app(folder.root, rehearsal_speed=SPEED)
    with (
        closing(app.extensions[EXTENSION].database),
        opened(folder.rehearsal) as database,
    ):
        first = Attacker(**vars(participant_of(folder, database, "first")))
        second = replace(first, name="second", trials=[])
        with browser(app) as client:
            assert first.take_part(client)
            first.attack_after_the_end(client)
        with browser(app) as client:
            assert second.take_part(client)
            first.attack(second, client)
        with database.reading() as session:
            assert first.attacked == set(session.scalars(select(Trial.part)))
    assert first.attempts >= FORMS | {"a later trial", "a reason that is not offered"}
