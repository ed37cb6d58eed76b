"""Whole small rehearsals through the real server."""

from __future__ import annotations

from contextlib import closing

import pandas as pd

from studyapp.definition.folder import StudyFolder
from studyapp.rehearsal.run import rehearse
from studyapp.services.database import Database, sqlite_url
from studyapp.services.export import responses_table


def answers(folder: StudyFolder) -> pd.DataFrame:
    with closing(Database.open(sqlite_url(folder.rehearsal))) as database:
        return responses_table(database)


def test_everybody_gets_a_completion_code_and_every_answer_is_stored(folder: StudyFolder) -> None:
    seen: list[tuple[int, int]] = []
    result = rehearse(folder, seed=3, on_done=lambda done, total: seen.append((done, total)))
    assert (result.completed, result.kept) == (6, 0)
    assert seen == [(done, 6) for done in range(7)]
    table = answers(folder)
    # 1 practice, 2 main, 1 repeat, 1 catch; two questions each.
    assert table.groupby("study_session").size().tolist() == [10] * 6
    assert table.groupby("comparison")["study_session"].nunique().tolist() == [3, 3]
    assert table["value"].between(-2, 2).all()
    assert (table["watched"] == 1).all()
    assert not folder.responses.exists()
