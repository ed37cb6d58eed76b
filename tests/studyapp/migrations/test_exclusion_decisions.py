"""The step that keeps what researchers decide about participants."""

from __future__ import annotations

import pytest
from alembic import command
from sqlalchemy import create_engine, text

from studyapp.services.database import migration_config
from tests.studyapp.migrations.test_recruitment_columns import NOW, filled

BEFORE = "0006"
AFTER = "0007"

DECISION = text(
    "INSERT INTO exclusion_decisions (at, study_session_id, excluded, researcher, reason) "
    "VALUES (:now, 1, TRUE, 'Ada', 'asleep')"
)


def test_no_decision_is_lost_on_the_way_back(empty_url: str) -> None:
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        config = migration_config(connection)
        command.upgrade(config, "0004")
        filled(connection)
        command.upgrade(config, AFTER)
        command.downgrade(config, BEFORE)
        command.upgrade(config, AFTER)
        connection.execute(DECISION, {"now": NOW})

        with pytest.raises(ValueError, match="would be lost"):
            command.downgrade(config, BEFORE)

        kept = connection.execute(text("SELECT reason FROM exclusion_decisions")).all()
    assert kept == [("asleep",)]
    engine.dispose()
