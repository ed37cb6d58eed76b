"""How videos played, the sound check, breaks, and requests that were refused."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

NOT_NULL: Final[Mapping[str, Mapping[str, tuple[sa.types.TypeEngine[Any], str]]]] = {
    "watch_batches": {
        "rate": (sa.Double(), "1"),
        "hidden_seconds": (sa.Double(), "0"),
        "silent_seconds": (sa.Double(), "0"),
        "stalls": (sa.Integer(), "0"),
        "stalled_seconds": (sa.Double(), "0"),
    },
    "study_sessions": {
        "sound_digits": (sa.String(length=8), "''"),
        "sound_tries": (sa.Integer(), "0"),
    },
}
"""New columns with what they hold from the start."""

NULLABLE: Final[Mapping[str, Mapping[str, sa.types.TypeEngine[Any]]]] = {
    "watch_batches": {"frames": sa.Integer(), "dropped_frames": sa.Integer()},
    "videos": {"unplayable_at": sa.DateTime(timezone=True)},
    "study_sessions": {
        "sound_checked_at": sa.DateTime(timezone=True),
        "rested_at_position": sa.Integer(),
    },
}


def upgrade() -> None:
    """Take the step."""
    for table, columns in NOT_NULL.items():
        for name, (kind, start) in columns.items():
            column = sa.Column(name, kind, nullable=False, server_default=sa.text(start))
            op.add_column(table, column)
    for table, empty in NULLABLE.items():
        for name, kind in empty.items():
            op.add_column(table, sa.Column(name, kind, nullable=True))
    op.create_table(
        "refusals",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=True),
        sa.Column("kind", sa.String(length=40), nullable=False),
        sa.Column("detail", sa.String(length=300), nullable=False),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_refusals_study_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_refusals")),
    )
    op.create_index(op.f("ix_refusals_study_session_id"), "refusals", ["study_session_id"])


def downgrade() -> None:
    """Take it back; it fails where something is stored that the second schema cannot hold."""
    connection = op.get_bind()
    if _stored(connection):
        raise ValueError("what was measured, checked or refused since would be lost")
    op.drop_index(op.f("ix_refusals_study_session_id"), "refusals")
    op.drop_table("refusals")
    for table, columns in (*NOT_NULL.items(), *NULLABLE.items()):
        for name in columns:
            op.drop_column(table, name)


def _stored(connection: sa.Connection) -> bool:
    """Tell whether the new table or a new column holds more than it began with."""
    changed: dict[str, list[sa.ColumnElement[bool]]] = {"refusals": [sa.true()]}
    for table, columns in NOT_NULL.items():
        changed.setdefault(table, []).extend(
            sa.column(name) != sa.text(start) for name, (_, start) in columns.items()
        )
    for table, empty in NULLABLE.items():
        changed.setdefault(table, []).extend(sa.column(name).is_not(None) for name in empty)
    return any(
        connection.scalar(
            sa.select(sa.func.count()).select_from(sa.table(table)).where(sa.or_(*clauses))
        )
        for table, clauses in changed.items()
    )
