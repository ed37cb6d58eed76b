"""The first schema."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Take the step."""
    op.create_table(
        "study_sessions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("token", sa.String(length=64), nullable=False),
        sa.Column("visit", sa.String(length=64), nullable=True),
        sa.Column("recruiter_participant", sa.String(length=200), nullable=True),
        sa.Column("recruiter_study", sa.String(length=200), nullable=False),
        sa.Column("recruiter_session", sa.String(length=200), nullable=False),
        sa.Column("comparison", sa.String(length=202), nullable=False),
        sa.Column("reference", sa.String(length=100), nullable=False),
        sa.Column("other", sa.String(length=100), nullable=False),
        sa.Column("consented_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("started_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("last_active_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("completed_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("withdrawn_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("completion_code", sa.String(length=32), nullable=True),
        sa.CheckConstraint(
            "(completion_code IS NULL) = (completed_at IS NULL)",
            name=op.f("ck_study_sessions_code_only_when_completed"),
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_study_sessions")),
        sa.UniqueConstraint("completion_code", name=op.f("uq_study_sessions_completion_code")),
        sa.UniqueConstraint(
            "recruiter_participant",
            "recruiter_study",
            name=op.f("uq_study_sessions_recruiter_participant_recruiter_study"),
        ),
        sa.UniqueConstraint("token", name=op.f("uq_study_sessions_token")),
        sa.UniqueConstraint("visit", name=op.f("uq_study_sessions_visit")),
    )
    op.create_table(
        "places",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("comparison", sa.String(length=202), nullable=False),
        sa.Column("reference", sa.String(length=100), nullable=False),
        sa.Column("other", sa.String(length=100), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=True),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_places_study_session_id"),
            ondelete="SET NULL",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_places")),
        sa.UniqueConstraint("comparison", "number", name=op.f("uq_places_comparison_number")),
        sa.UniqueConstraint("study_session_id", name=op.f("uq_places_study_session_id")),
    )
    op.create_table(
        "trials",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(length=10), nullable=False),
        sa.Column("segment", sa.String(length=100), nullable=False),
        sa.Column("emotion", sa.String(length=100), nullable=False),
        sa.Column("speaker", sa.String(length=200), nullable=False),
        sa.Column("left_condition", sa.String(length=100), nullable=False),
        sa.Column("right_condition", sa.String(length=100), nullable=False),
        sa.Column("expected", sa.String(length=5), nullable=False),
        sa.Column("repeats", sa.Integer(), nullable=True),
        sa.Column("duration", sa.Double(), nullable=False),
        sa.Column("media_token", sa.String(length=64), nullable=False),
        sa.Column("shown_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("answered_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("unplayable_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("seconds", sa.Double(), nullable=True),
        sa.CheckConstraint(
            "(kind = 'catch') = (expected IN ('left', 'right'))", name=op.f("ck_trials_expected")
        ),
        sa.CheckConstraint(
            "kind IN ('practice', 'main', 'repeat', 'catch')", name=op.f("ck_trials_kind")
        ),
        sa.CheckConstraint(
            "answered_at IS NULL OR unplayable_at IS NULL", name=op.f("ck_trials_one_outcome")
        ),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_trials_study_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_trials")),
        sa.UniqueConstraint("media_token", name=op.f("uq_trials_media_token")),
        sa.UniqueConstraint(
            "study_session_id", "position", name=op.f("uq_trials_study_session_id_position")
        ),
    )
    op.create_table(
        "responses",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("trial_id", sa.Integer(), nullable=False),
        sa.Column("question", sa.String(length=100), nullable=False),
        sa.Column("value", sa.Integer(), nullable=False),
        sa.Column("answered_at", sa.DateTime(timezone=True), nullable=False),
        sa.CheckConstraint("value BETWEEN -2 AND 2", name=op.f("ck_responses_value")),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trials.id"], name=op.f("fk_responses_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_responses")),
        sa.UniqueConstraint("trial_id", "question", name=op.f("uq_responses_trial_id_question")),
    )
    op.create_table(
        "watch_batches",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("trial_id", sa.Integer(), nullable=False),
        sa.Column("batch", sa.Integer(), nullable=False),
        sa.Column("intervals", sa.JSON(), nullable=False),
        sa.Column("received_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trials.id"], name=op.f("fk_watch_batches_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_watch_batches")),
        sa.UniqueConstraint("trial_id", "batch", name=op.f("uq_watch_batches_trial_id_batch")),
    )


def downgrade() -> None:
    """Take it back."""
    op.drop_table("watch_batches")
    op.drop_table("responses")
    op.drop_table("trials")
    op.drop_table("places")
    op.drop_table("study_sessions")
