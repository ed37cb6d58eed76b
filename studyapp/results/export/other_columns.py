"""The tables of an export beside the answers."""

from __future__ import annotations

from typing import Final

from studyapp.results.export.columns import (
    ARM,
    EXCLUSION,
    KIND,
    PART,
    PARTICIPANT,
    POSITION,
    SEGMENT,
    STUDY_SESSION,
    VERSION,
    Column,
    TableColumns,
)

NOT_COUNTED: Final = "the browser does not count pictures"

PARTICIPANTS: Final = TableColumns(
    name="participants",
    title="One study session. Who withdrew, or was forgotten, is in this table alone.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION, VERSION, ARM),
        Column("state", "text", "Where the study session stands."),
        Column(
            "consented_at",
            "moment",
            "When the participant agreed; of who was forgotten, when that was.",
        ),
        Column(
            "started_at",
            "moment",
            "When the first trial was shown.",
            missing="it never was, or who withdrew was promised deletion",
        ),
        Column(
            "completed_at", "moment", "When the last answer was stored.", missing="it never was"
        ),
        Column(
            "presentations",
            "integer",
            "How many trials were planned; none are left of who withdrew.",
        ),
        Column("answered", "integer", "How many of them were answered."),
        Column(
            "unplayable", "integer", "Of how many the participant said that a video does not play."
        ),
        *EXCLUSION,
    ),
)

FORM: Final = TableColumns(
    name="form",
    title="One answer of a participant about themselves.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION),
        Column("stage", "text", "When it was asked."),
        Column("question", "text", "The question; the codebook has its wording."),
        Column(
            "value",
            "text",
            "The answer as it was given.",
            missing="a question that need not be answered was left open",
            free_text=True,
        ),
    ),
)

WATCHING: Final = TableColumns(
    name="watching",
    title="One video of one trial that was shown, and how it was watched.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION, VERSION, ARM, PART, POSITION, KIND, SEGMENT),
        Column(
            "video",
            "integer",
            "The video's place on the page, from 1; 0 is the reference shown apart.",
        ),
        Column(
            "stimuli",
            "text",
            "Numbers of the stimuli it shows, from left to right, separated by spaces.",
        ),
        Column("conditions", "text", "Their conditions, from left to right, separated by spaces."),
        Column(
            "made_from",
            "text",
            "Digest of all that the video was made from. Where it differs, participants "
            "saw another video of the same condition and segment.",
        ),
        Column("duration", "number", "Length of the video.", unit="s"),
        Column(
            "watched", "number", "Share that counts as watched, in [0, 1], replays counted once."
        ),
        Column(
            "sent_at",
            "moment",
            "When the server first sent the video, or led the browser to the store.",
            missing="it never did, and so nothing counts as watched",
        ),
        Column(
            "times_played",
            "number",
            "Time played in any way, replays included, over the video's length.",
        ),
        Column("rate", "number", "Largest playback rate seen; 1 is as recorded."),
        Column(
            "hidden_seconds", "number", "How long it played where nobody could see it.", unit="s"
        ),
        Column(
            "silent_seconds", "number", "How long it played where nobody could hear it.", unit="s"
        ),
        Column("stalls", "integer", "How often it waited for data while it was meant to play."),
        Column("stalled_seconds", "number", "How long it waited in all.", unit="s"),
        Column(
            "frames", "integer", "How many pictures the browser had to show.", missing=NOT_COUNTED
        ),
        Column(
            "dropped_share",
            "number",
            "Share of them that it left out, in [0, 1].",
            missing=NOT_COUNTED,
        ),
        Column(
            "unplayable_at",
            "moment",
            "When the participant said that it does not play.",
            missing="they did not say so",
        ),
    ),
)

REFUSALS: Final = TableColumns(
    name="refusals",
    title="One request that was refused and changed nothing.",
    columns=(
        Column(
            "participant", "text", PARTICIPANT.meaning, missing="the address belonged to nobody"
        ),
        Column(
            "study_session",
            "integer",
            STUDY_SESSION.meaning,
            missing="the address belonged to nobody",
        ),
        Column("at", "moment", "When it was."),
        Column("kind", "text", "What was wrong, in a word."),
        Column("detail", "text", "What was asked for, and why it was refused."),
    ),
)

LOG: Final = TableColumns(
    name="log",
    title="One change that was made while the study ran.",
    columns=(
        Column("at", "moment", "When it was."),
        Column("event", "text", "What was done, by a name that never changes."),
        Column(
            "detail", "text", "What there is to know beside it.", missing="nothing", free_text=True
        ),
        Column(
            "researcher",
            "text",
            "Who did it. It names a person.",
            missing="the server or the command line did",
            free_text=True,
        ),
        Column(
            "reason", "text", "Why, in their words.", missing="none was asked for", free_text=True
        ),
    ),
)

RECRUITER_IDS: Final = TableColumns(
    name="recruiter_ids",
    title="One study session, and the names by which the recruiter knows it. It names people: "
    "keep it to yourself.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION),
        Column(
            "recruiter_participant",
            "text",
            "The recruiter's name for the participant.",
            free_text=True,
        ),
        Column(
            "recruiter_study",
            "text",
            "The recruiter's name for the study.",
            missing="none was given",
            free_text=True,
        ),
        Column(
            "recruiter_session",
            "text",
            "The recruiter's name for the sitting.",
            missing="none was given, or who withdrew was promised deletion",
            free_text=True,
        ),
    ),
)
