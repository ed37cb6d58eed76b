"""Exports are looks at results too."""

from __future__ import annotations

from typing import Final

import sqlalchemy as sa
from alembic import op

from studyapp.migrations.carrying import put_in, take_out

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

LOOKS: Final = "looks"


def upgrade() -> None:
    """Take the step."""
    _make_anew("'page', 'report', 'export'")


def downgrade() -> None:
    """Take it back; it fails where anything was exported."""
    table = sa.table(LOOKS, sa.column("way"))
    exported = sa.select(sa.literal(1)).where(table.c.way == "export").limit(1)
    if op.get_bind().scalar(exported) is not None:
        raise ValueError("that answers were exported would be lost")
    _make_anew("'page', 'report'")


def _make_anew(ways: str) -> None:
    """Make the table with other ways; SQLite changes no constraint of one that there is."""
    rows = take_out(op.get_bind(), [LOOKS])
    op.create_table(
        LOOKS,
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("way", sa.String(length=10), nullable=False),
        sa.Column("researcher", sa.String(length=100), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("finished", sa.Integer(), nullable=False),
        sa.Column("planned", sa.Integer(), nullable=False),
        sa.Column("answers", sa.Integer(), nullable=False),
        sa.CheckConstraint(f"way IN ({ways})", name=op.f("ck_looks_way")),
        sa.CheckConstraint(
            "finished >= 0 AND planned >= 0 AND answers >= 0", name=op.f("ck_looks_counts")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_looks")),
    )
    put_in(op.get_bind(), rows)
