"""What Alembic runs: the caller has opened the connection and its transaction."""

from __future__ import annotations

from alembic import context

from studyapp.database.tables.base import Base

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=Base.metadata,
    render_as_batch=True,
    compare_type=True,
)
context.run_migrations()
