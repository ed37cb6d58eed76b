"""The first schema."""

import sqlalchemy as sa
from alembic import op

revision = "first"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Make all tables."""
    op.create_table(
        "alarms",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(length=20), nullable=False),
        sa.Column("about", sa.String(length=100), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_alarms")),
        sa.UniqueConstraint("kind", "about", name=op.f("uq_alarms_kind_about")),
    )
    op.create_table(
        "audit_lines",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("event", sa.String(length=40), nullable=False),
        sa.Column("study_session", sa.Integer(), nullable=True),
        sa.Column("detail", sa.Text(), nullable=False),
        sa.Column(
            "researcher", sa.String(length=100), server_default=sa.text("''"), nullable=False
        ),
        sa.Column("reason", sa.Text(), server_default=sa.text("''"), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_audit_lines")),
    )
    op.create_table(
        "intake_changes",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("state", sa.String(length=10), nullable=False),
        sa.Column("more_places", sa.Integer(), nullable=False),
        sa.Column("researcher", sa.String(length=100), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.CheckConstraint(
            "state IN ('open', 'paused', 'closed')", name=op.f("ck_intake_changes_state")
        ),
        sa.CheckConstraint("more_places >= 0", name=op.f("ck_intake_changes_more_places")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_intake_changes")),
    )
    op.create_table(
        "interim_figures",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("what", sa.String(length=20), nullable=False),
        sa.Column("begun_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("tried_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("state", sa.String(length=100), server_default=sa.text("''"), nullable=False),
        sa.Column("document", sa.Text(), server_default=sa.text("''"), nullable=False),
        sa.Column("problem", sa.Text(), server_default=sa.text("''"), nullable=False),
        sa.CheckConstraint(
            "what IN ('agreement', 'results')", name=op.f("ck_interim_figures_what")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_interim_figures")),
        sa.UniqueConstraint("what", name=op.f("uq_interim_figures_what")),
    )
    op.create_table(
        "invitations",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("token_hash", sa.String(length=64), nullable=False),
        sa.Column("made_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_invitations")),
        sa.UniqueConstraint("token_hash", name=op.f("uq_invitations_token_hash")),
    )
    op.create_table(
        "login_attempts",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("name_hash", sa.String(length=64), nullable=False),
        sa.Column("address", sa.String(length=64), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_login_attempts")),
    )
    op.create_index(op.f("ix_login_attempts_address"), "login_attempts", ["address"], unique=False)
    op.create_index(op.f("ix_login_attempts_at"), "login_attempts", ["at"], unique=False)
    op.create_index(
        op.f("ix_login_attempts_name_hash"), "login_attempts", ["name_hash"], unique=False
    )
    op.create_table(
        "looks",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("way", sa.String(length=10), nullable=False),
        sa.Column("researcher", sa.String(length=100), nullable=False),
        sa.Column("reason", sa.Text(), nullable=False),
        sa.Column("finished", sa.Integer(), nullable=False),
        sa.Column("planned", sa.Integer(), nullable=False),
        sa.Column("answers", sa.Integer(), nullable=False),
        sa.CheckConstraint("way IN ('page', 'report', 'export')", name=op.f("ck_looks_way")),
        sa.CheckConstraint(
            "finished >= 0 AND planned >= 0 AND answers >= 0", name=op.f("ck_looks_counts")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_looks")),
    )
    op.create_table(
        "newcomers",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("address", sa.String(length=64), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_newcomers")),
    )
    op.create_index(op.f("ix_newcomers_address"), "newcomers", ["address"], unique=False)
    op.create_index(op.f("ix_newcomers_at"), "newcomers", ["at"], unique=False)
    op.create_table(
        "researchers",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(length=100), nullable=False),
        sa.Column("name_key", sa.String(length=200), nullable=False),
        sa.Column("role", sa.String(length=10), nullable=False),
        sa.Column("password_hash", sa.String(length=300), nullable=False),
        sa.Column("joined_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("disabled_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("totp_secret", sa.String(length=64), nullable=True),
        sa.Column("totp_step", sa.Integer(), server_default=sa.text("0"), nullable=False),
        sa.Column("recovery_hashes", sa.JSON(), server_default=sa.text("'[]'"), nullable=False),
        sa.CheckConstraint(
            "role IN ('owner', 'analyst', 'viewer')", name=op.f("ck_researchers_role")
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_researchers")),
        sa.UniqueConstraint("name_key", name=op.f("uq_researchers_name_key")),
    )
    op.create_table(
        "screen_outs",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("participant", sa.String(length=200), nullable=False),
        sa.Column("screened_out_at", sa.DateTime(timezone=True), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_screen_outs")),
        sa.UniqueConstraint("participant", name=op.f("uq_screen_outs_participant")),
    )
    op.create_table(
        "study_versions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.Column("design", sa.String(length=64), nullable=False),
        sa.Column("definition", sa.Text(), nullable=False),
        sa.Column("operation", sa.JSON(), nullable=False),
        sa.Column("opened_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("in_force", sa.Boolean(), server_default=sa.text("true"), nullable=False),
        sa.Column(
            "screened_by_eligibility", sa.Integer(), server_default=sa.text("0"), nullable=False
        ),
        sa.Column("screened_by_consent", sa.Integer(), server_default=sa.text("0"), nullable=False),
        sa.Column(
            "screened_by_comprehension", sa.Integer(), server_default=sa.text("0"), nullable=False
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_study_versions")),
        sa.UniqueConstraint("design", name=op.f("uq_study_versions_design")),
        sa.UniqueConstraint("number", name=op.f("uq_study_versions_number")),
    )
    op.create_table(
        "researcher_links",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("token_hash", sa.String(length=64), nullable=False),
        sa.Column("purpose", sa.String(length=20), nullable=False),
        sa.Column("role", sa.String(length=10), nullable=True),
        sa.Column("researcher_id", sa.Integer(), nullable=True),
        sa.Column("made_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("expires_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("made_by", sa.String(length=100), nullable=False),
        sa.CheckConstraint(
            "(purpose = 'new_password') = (researcher_id IS NOT NULL)",
            name=op.f("ck_researcher_links_whose"),
        ),
        sa.CheckConstraint(
            "purpose IN ('first_owner', 'invitation', 'new_password')",
            name=op.f("ck_researcher_links_purpose"),
        ),
        sa.CheckConstraint(
            "(role IS NULL) = (researcher_id IS NOT NULL)", name=op.f("ck_researcher_links_role")
        ),
        sa.ForeignKeyConstraint(
            ["researcher_id"],
            ["researchers.id"],
            name=op.f("fk_researcher_links_researcher_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_researcher_links")),
        sa.UniqueConstraint("token_hash", name=op.f("uq_researcher_links_token_hash")),
    )
    op.create_index(
        op.f("ix_researcher_links_researcher_id"),
        "researcher_links",
        ["researcher_id"],
        unique=False,
    )
    op.create_table(
        "researcher_logins",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("researcher_id", sa.Integer(), nullable=False),
        sa.Column("token_hash", sa.String(length=64), nullable=False),
        sa.Column("began_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("last_active_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("unblinded_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("unblinding_reason", sa.Text(), server_default=sa.text("''"), nullable=False),
        sa.ForeignKeyConstraint(
            ["researcher_id"],
            ["researchers.id"],
            name=op.f("fk_researcher_logins_researcher_id"),
            ondelete="CASCADE",
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_researcher_logins")),
        sa.UniqueConstraint("token_hash", name=op.f("uq_researcher_logins_token_hash")),
    )
    op.create_index(
        op.f("ix_researcher_logins_researcher_id"),
        "researcher_logins",
        ["researcher_id"],
        unique=False,
    )
    op.create_table(
        "study_sessions",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("token", sa.String(length=64), nullable=False),
        sa.Column("visit", sa.String(length=64), nullable=True),
        sa.Column("recruiter_participant", sa.String(length=200), nullable=True),
        sa.Column("recruiter_study", sa.String(length=200), nullable=False),
        sa.Column("recruiter_session", sa.String(length=200), nullable=False),
        sa.Column("submit_to", sa.String(length=200), server_default=sa.text("''"), nullable=False),
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
        sa.Column("unproven_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("completion_code", sa.String(length=32), nullable=True),
        sa.Column("outcome", sa.String(length=20), nullable=True),
        sa.Column(
            "sound_digits", sa.String(length=8), server_default=sa.text("''"), nullable=False
        ),
        sa.Column("sound_tries", sa.Integer(), server_default=sa.text("0"), nullable=False),
        sa.Column("sound_checked_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("rested_at_position", sa.Integer(), nullable=True),
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
            "recruiter_participant", name=op.f("uq_study_sessions_recruiter_participant")
        ),
        sa.UniqueConstraint("token", name=op.f("uq_study_sessions_token")),
        sa.UniqueConstraint("visit", name=op.f("uq_study_sessions_visit")),
    )
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
        unique=False,
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
    op.create_index(
        op.f("ix_refusals_study_session_id"), "refusals", ["study_session_id"], unique=False
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
        sa.Column("made_from", sa.String(length=64), server_default=sa.text("''"), nullable=False),
        sa.Column("sent_at", sa.DateTime(timezone=True), nullable=True),
        sa.Column("unplayable_at", sa.DateTime(timezone=True), nullable=True),
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
        "watch_records",
        sa.Column("id", sa.Integer(), nullable=False),
        sa.Column("video_id", sa.Integer(), nullable=False),
        sa.Column("intervals", sa.JSON(), nullable=False),
        sa.Column("played_seconds", sa.Double(), nullable=False),
        sa.Column("rate", sa.Double(), nullable=False),
        sa.Column("hidden_seconds", sa.Double(), nullable=False),
        sa.Column("silent_seconds", sa.Double(), nullable=False),
        sa.Column("stalls", sa.Integer(), nullable=False),
        sa.Column("stalled_seconds", sa.Double(), nullable=False),
        sa.Column("frames", sa.Integer(), nullable=True),
        sa.Column("dropped_frames", sa.Integer(), nullable=True),
        sa.Column("latest", sa.JSON(), nullable=False),
        sa.Column("reported_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(
            ["video_id"], ["videos.id"], name=op.f("fk_watch_records_video_id"), ondelete="CASCADE"
        ),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_watch_records")),
        sa.UniqueConstraint("video_id", name=op.f("uq_watch_records_video_id")),
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


def downgrade() -> None:
    """Drop them."""
    op.drop_index(
        "uq_responses_trial_id_question",
        table_name="responses",
        sqlite_where=sa.text("stimulus IS NULL"),
        postgresql_where=sa.text("stimulus IS NULL"),
    )
    op.drop_table("responses")
    op.drop_table("watch_records")
    op.drop_table("trial_stimuli")
    op.drop_table("videos")
    op.drop_table("trials")
    op.drop_index(op.f("ix_refusals_study_session_id"), table_name="refusals")
    op.drop_table("refusals")
    op.drop_table("places")
    op.drop_table("form_answers")
    op.drop_index(op.f("ix_exclusion_decisions_study_session_id"), table_name="exclusion_decisions")
    op.drop_table("exclusion_decisions")
    op.drop_table("study_sessions")
    op.drop_index(op.f("ix_researcher_logins_researcher_id"), table_name="researcher_logins")
    op.drop_table("researcher_logins")
    op.drop_index(op.f("ix_researcher_links_researcher_id"), table_name="researcher_links")
    op.drop_table("researcher_links")
    op.drop_table("study_versions")
    op.drop_table("screen_outs")
    op.drop_table("researchers")
    op.drop_index(op.f("ix_newcomers_at"), table_name="newcomers")
    op.drop_index(op.f("ix_newcomers_address"), table_name="newcomers")
    op.drop_table("newcomers")
    op.drop_table("looks")
    op.drop_index(op.f("ix_login_attempts_name_hash"), table_name="login_attempts")
    op.drop_index(op.f("ix_login_attempts_at"), table_name="login_attempts")
    op.drop_index(op.f("ix_login_attempts_address"), table_name="login_attempts")
    op.drop_table("login_attempts")
    op.drop_table("invitations")
    op.drop_table("interim_figures")
    op.drop_table("intake_changes")
    op.drop_table("audit_lines")
    op.drop_table("alarms")
