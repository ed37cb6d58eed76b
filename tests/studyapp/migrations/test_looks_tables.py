"""The step that adds the log of looks at results."""

from __future__ import annotations

import pytest
from alembic import command
from sqlalchemy import create_engine, text

from studyapp.services.database import migration_config

LOOK = text(
    "INSERT INTO looks (at, way, researcher, reason, finished, planned, answers) "
    "VALUES ('2026-05-04 00:00:00.000000', 'page', 'Ada', 'curious', 3, 25, 90)"
)


@pytest.mark.parametrize("empty_url", ["sqlite", "postgresql"], indirect=True)
def test_a_look_is_not_lost_on_the_way_back(empty_url: str) -> None:
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        config = migration_config(connection)
        command.upgrade(config, "0008")
        command.downgrade(config, "0007")
        command.upgrade(config, "0008")
        connection.execute(LOOK)

        with pytest.raises(ValueError, match="would be lost"):
            command.downgrade(config, "0007")
    engine.dispose()


@pytest.mark.parametrize("empty_url", ["sqlite", "postgresql"], indirect=True)
def test_looks_stay_when_exports_become_some(empty_url: str) -> None:
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        config = migration_config(connection)
        command.upgrade(config, "0008")
        connection.execute(LOOK)
        before = connection.execute(text("SELECT * FROM looks")).all()

        command.upgrade(config, "0009")
        assert connection.execute(text("SELECT * FROM looks")).all() == before
        command.downgrade(config, "0008")
        assert connection.execute(text("SELECT * FROM looks")).all() == before
        command.upgrade(config, "0009")
        connection.execute(text(str(LOOK).replace("page", "export")))
        assert [row.id for row in connection.execute(text("SELECT id FROM looks"))] == [1, 2]

        with pytest.raises(ValueError, match="would be lost"):
            command.downgrade(config, "0008")
    engine.dispose()
