"""Looks at results before the end, and what was last computed of the answers so far."""

from __future__ import annotations

from typing import Final

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

MOMENT: Final = sa.DateTime(timezone=True)
EMPTY: Final = sa.text("''")


def upgrade() -> None:
    """Take the step."""
    op.create_table(
        "looks",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", MOMENT, nullable=False),
        sa.Column("way", sa.String(length=10), nullable=False),
        sa.Column("researcher", sa.String(length=100), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("finished", sa.Integer(), nullable=False),
        sa.Column("planned", sa.Integer(), nullable=False),
        sa.Column("answers", sa.Integer(), nullable=False),
        sa.CheckConstraint("way IN ('page', 'report')", name=op.f("ck_looks_way")),
        sa.CheckConstraint(
            "finished >= 0 AND planned >= 0 AND answers >= 0", name=op.f("ck_looks_counts")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_looks")),
    )
    op.create_table(
        "interim_figures",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("what", sa.String(length=20), nullable=False),
        sa.Column("begun_at", MOMENT, nullable=True),
        sa.Column("tried_at", MOMENT, nullable=True),
        sa.Column("state", sa.String(length=100), nullable=False, server_default=EMPTY),
        sa.Column("document", sa.Text(), nullable=False, server_default=EMPTY),
        sa.Column("problem", sa.Text(), nullable=False, server_default=EMPTY),
        sa.CheckConstraint(
            "what IN ('agreement', 'results')", name=op.f("ck_interim_figures_what")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_interim_figures")),
        sa.UniqueConstraint("what", name=op.f("uq_interim_figures_what")),
    )
    op.add_column("researcher_logins", sa.Column("unblinded_at", MOMENT, nullable=True))
    reason = sa.Column("unblinding_reason", sa.Text(), nullable=False, server_default=EMPTY)
    op.add_column("researcher_logins", reason)


def downgrade() -> None:
    """Take it back; it fails where anybody has looked."""
    found = sa.select(sa.literal(1)).select_from(sa.table("looks")).limit(1)
    if op.get_bind().scalar(found) is not None:
        raise ValueError("that results were looked at would be lost")
    for column in ("unblinding_reason", "unblinded_at"):
        op.drop_column("researcher_logins", column)
    for table in ("interim_figures", "looks"):
        op.drop_table(table)
