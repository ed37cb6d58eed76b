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

TRIALS = {
    "the same answers twice": 200,
    "other answers to an answered trial": 409,
    "somebody else's trial": 403,
    "trouble with somebody else's trial": 403,
    "trouble with somebody else's video": 422,
    "playing reported of nobody's video": 403,
    "playing reported backwards": 422,
    "a value that is out of range": 422,
    "two values for one question": 422,
    "an answer that nobody asked for": 422,
    "a reason that is not offered": 422,
}
FORMS = {
    "no answer to the question 'adult'": 422,
    "an answer that excludes to the question 'adult'": 403,
    "an answer that excludes to the question 'watched'": 403,
    "too high a number to the question 'age'": 422,
    "too long an answer to the question 'work'": 422,
    "an answer that is not offered to the question 'often'": 422,
    "digits that were not spoken": 422,
    "no digits": 422,
}
AFTER_THE_END = {
    "the last answers again after the end": 200,
    "other answers after the end": 409,
    "trouble after the end": 409,
    "playing reported after the end": 409,
    "beginning after the end": 200,
    "withdrawing after the end": 409,
    "answers of nobody": 404,
}
IN_ANOTHERS_NAME = {
    "answers at another's address": 403,
    "answers to another's trial": 403,
    "trouble with another's video": 409,
    "playing reported of another's video": 403,
}


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
    assert first.statuses["a later trial"] in {409, 422}
    expected = TRIALS | FORMS | AFTER_THE_END | IN_ANOTHERS_NAME
    assert {what: first.statuses.get(what) for what in expected} == expected
