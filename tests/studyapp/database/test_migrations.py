from __future__ import annotations

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import create_engine, inspect

from studyapp.database.engine import Database, migration_config
from studyapp.database.tables import Base

KINDS = ["sqlite", "postgresql"]


@pytest.mark.parametrize("database_url", KINDS, indirect=True)
def test_the_migrated_schema_matches_the_models(database: Database) -> None:
    with database.engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []


@pytest.mark.parametrize("empty_url", KINDS, indirect=True)
def test_every_migration_goes_up_and_down_again(empty_url: str) -> None:
    engine = create_engine(empty_url)
    with engine.begin() as connection:
        config = migration_config(connection)
        steps = list(ScriptDirectory.from_config(config).walk_revisions())[::-1]
        for step, before in zip(steps, ["base", *(each.revision for each in steps)], strict=False):
            command.upgrade(config, step.revision)
            command.downgrade(config, before)
            command.upgrade(config, step.revision)
        assert set(Base.metadata.tables) <= set(inspect(connection).get_table_names())
        command.downgrade(config, "base")
        assert inspect(connection).get_table_names() == ["alembic_version"]
    engine.dispose()
