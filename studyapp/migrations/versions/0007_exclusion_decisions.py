"""Whom researchers leave out of the analysis, or take in again, and why."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Take the step."""
    op.create_table(
        "exclusion_decisions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=False),
        sa.Column("excluded", sa.Boolean(), nullable=False),
        sa.Column("researcher", sa.String(length=100), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_exclusion_decisions_study_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_exclusion_decisions")),
    )
    op.create_index(
        op.f("ix_exclusion_decisions_study_session_id"),
        "exclusion_decisions",
        ["study_session_id"],
    )


def downgrade() -> None:
    """Take it back; it fails where anybody has decided something."""
    found = sa.select(sa.literal(1)).select_from(sa.table("exclusion_decisions")).limit(1)
    if op.get_bind().scalar(found) is not None:
        raise ValueError("whom researchers have excluded would be lost")
    op.drop_table("exclusion_decisions")
