"""Arms, stimuli and versions: room for every protocol."""

from __future__ import annotations

from importlib import import_module

import sqlalchemy as sa
from alembic import op

from studyapp.migrations.carrying import put_in, take_out
from studyapp.migrations.pair_rows import with_arms, without_arms

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

OLD_TABLES = ("watch_batches", "responses", "trials", "places", "study_sessions")
NEW_TABLES = (
    "watch_batches",
    "responses",
    "trial_stimuli",
    "videos",
    "trials",
    "places",
    "form_answers",
    "study_sessions",
    "study_versions",
    "audit_lines",
)


def upgrade() -> None:
    """Take the step."""
    connection = op.get_bind()
    old = take_out(connection, OLD_TABLES)
    _create_tables()
    put_in(connection, with_arms(old))


def downgrade() -> None:
    """Take it back; it fails where something is stored that the first schema cannot hold."""
    connection = op.get_bind()
    old = without_arms(take_out(connection, NEW_TABLES))
    import_module("studyapp.migrations.versions.0001_the_first_schema").upgrade()
    put_in(connection, old)


def _create_tables() -> None:
    op.create_table(
        "audit_lines",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("event", sa.String(length=100), nullable=False),
        sa.Column("detail", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_audit_lines")),
    )
    op.create_table(
        "study_versions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("design", sa.String(length=64), nullable=False),
        sa.Column("definition", sa.Text(), nullable=False),
        sa.Column("operation", sa.JSON(), nullable=False),
        sa.Column("opened_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_study_versions")),
        sa.UniqueConstraint("design", name=op.f("uq_study_versions_design")),
        sa.UniqueConstraint("number", name=op.f("uq_study_versions_number")),
    )
    op.create_table(
        "study_sessions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("token", sa.String(length=64), nullable=False),
        sa.Column("visit", sa.String(length=64), nullable=True),
        sa.Column("recruiter_participant", sa.String(length=200), nullable=True),
        sa.Column("recruiter_study", sa.String(length=200), nullable=False),
        sa.Column("recruiter_session", sa.String(length=200), nullable=False),
        sa.Column("version_id", sa.Integer(), nullable=False),
        sa.Column("arm", sa.String(length=202), nullable=False),
        sa.Column("arm_design", sa.String(length=64), nullable=False),
        sa.Column("number", sa.Integer(), nullable=True),
        sa.Column("conditions", sa.JSON(), nullable=False),
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
        sa.ForeignKeyConstraint(
            ["version_id"], ["study_versions.id"], name=op.f("fk_study_sessions_version_id")
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
        "form_answers",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=False),
        sa.Column("stage", sa.String(length=20), nullable=False),
        sa.Column("question", sa.String(length=100), nullable=False),
        sa.Column("value", sa.Text(), nullable=False),
        sa.Column("answered_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_form_answers_study_session_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_form_answers")),
        sa.UniqueConstraint(
            "study_session_id", "question", name=op.f("uq_form_answers_study_session_id_question")
        ),
    )
    op.create_table(
        "places",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("arm", sa.String(length=202), nullable=False),
        sa.Column("design", sa.String(length=64), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=True),
        sa.ForeignKeyConstraint(
            ["study_session_id"],
            ["study_sessions.id"],
            name=op.f("fk_places_study_session_id"),
            ondelete="SET NULL",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_places")),
        sa.UniqueConstraint("arm", "design", "number", name=op.f("uq_places_arm_design_number")),
        sa.UniqueConstraint("study_session_id", name=op.f("uq_places_study_session_id")),
    )
    op.create_table(
        "trials",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("study_session_id", sa.Integer(), nullable=False),
        sa.Column("token", sa.String(length=64), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(length=10), nullable=False),
        sa.Column("part", sa.String(length=100), nullable=False),
        sa.Column("segment", sa.String(length=100), nullable=False),
        sa.Column("emotion", sa.String(length=100), nullable=False),
        sa.Column("speaker", sa.String(length=200), nullable=False),
        sa.Column("expected", sa.Integer(), nullable=True),
        sa.Column("instructed", sa.Integer(), nullable=True),
        sa.Column("repeats", sa.Integer(), nullable=True),
        sa.Column("shown_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("answered_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("unplayable_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("seconds", sa.Double(), nullable=True),
        sa.CheckConstraint(
            "(kind = 'attention') = (instructed IS NOT NULL)", name=op.f("ck_trials_instructed")
        ),
        sa.CheckConstraint(
            "(kind = 'catch') = (expected IS NOT NULL)", name=op.f("ck_trials_expected")
        ),
        sa.CheckConstraint(
            "kind IN ('practice', 'main', 'repeat', 'catch', 'attention')",
            name=op.f("ck_trials_kind"),
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
        sa.UniqueConstraint(
            "study_session_id", "position", name=op.f("uq_trials_study_session_id_position")
        ),
        sa.UniqueConstraint("token", name=op.f("uq_trials_token")),
    )
    op.create_table(
        "videos",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("trial_id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("token", sa.String(length=64), nullable=False),
        sa.Column("duration", sa.Double(), nullable=False),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trials.id"], name=op.f("fk_videos_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_videos")),
        sa.UniqueConstraint("token", name=op.f("uq_videos_token")),
        sa.UniqueConstraint("trial_id", "number", name=op.f("uq_videos_trial_id_number")),
    )
    op.create_table(
        "trial_stimuli",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("trial_id", sa.Integer(), nullable=False),
        sa.Column("video_id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("condition", sa.String(length=100), nullable=False),
        sa.Column("segment", sa.String(length=100), nullable=False),
        sa.Column("speech", sa.String(length=100), nullable=True),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trials.id"], name=op.f("fk_trial_stimuli_trial_id"), ondelete="CASCADE"
        ),
        sa.ForeignKeyConstraint(
            ["video_id"], ["videos.id"], name=op.f("fk_trial_stimuli_video_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_trial_stimuli")),
        sa.UniqueConstraint("trial_id", "number", name=op.f("uq_trial_stimuli_trial_id_number")),
    )
    op.create_table(
        "watch_batches",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("video_id", sa.Integer(), nullable=False),
        sa.Column("batch", sa.Integer(), nullable=False),
        sa.Column("intervals", sa.JSON(), nullable=False),
        sa.Column("received_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["video_id"], ["videos.id"], name=op.f("fk_watch_batches_video_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_watch_batches")),
        sa.UniqueConstraint("video_id", "batch", name=op.f("uq_watch_batches_video_id_batch")),
    )
    op.create_table(
        "responses",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("trial_id", sa.Integer(), nullable=False),
        sa.Column("question", sa.String(length=100), nullable=False),
        sa.Column("stimulus", sa.Integer(), nullable=True),
        sa.Column("value", sa.Integer(), nullable=False),
        sa.Column("reasons", sa.JSON(), nullable=False),
        sa.Column("answered_at", sa.DateTime(timezone=True), nullable=False),
        sa.CheckConstraint("value BETWEEN -2 AND 100", name=op.f("ck_responses_value")),
        sa.ForeignKeyConstraint(
            ["trial_id", "stimulus"],
            ["trial_stimuli.trial_id", "trial_stimuli.number"],
            name="fk_responses_stimulus",
            ondelete="CASCADE",
        ),
        sa.ForeignKeyConstraint(
            ["trial_id"], ["trials.id"], name=op.f("fk_responses_trial_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_responses")),
        sa.UniqueConstraint(
            "trial_id", "question", "stimulus", name=op.f("uq_responses_trial_id_question_stimulus")
        ),
    )
    op.create_index(
        "uq_responses_trial_id_question",
        "responses",
        ["trial_id", "question"],
        unique=True,
        sqlite_where=sa.text("stimulus IS NULL"),
        postgresql_where=sa.text("stimulus IS NULL"),
    )
