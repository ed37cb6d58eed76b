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
        Column(name="state", type="text", meaning="Where the study session stands."),
        Column(
            name="consented_at",
            type="moment",
            meaning="When the participant agreed; of who was forgotten, when that was.",
        ),
        Column(
            name="started_at",
            type="moment",
            meaning="When the first trial was shown.",
            missing="it never was, or who withdrew was promised deletion",
        ),
        Column(
            name="completed_at",
            type="moment",
            meaning="When the last answer was stored.",
            missing="it never was",
        ),
        Column(
            name="presentations",
            type="integer",
            meaning="How many trials were planned; none are left of who withdrew.",
        ),
        Column(name="answered", type="integer", meaning="How many of them were answered."),
        Column(
            name="unplayable",
            type="integer",
            meaning="Of how many the participant said that a video does not play.",
        ),
        *EXCLUSION,
    ),
)

FORM: Final = TableColumns(
    name="form",
    title="One answer of a participant about themselves.",
    columns=(
        *(PARTICIPANT, STUDY_SESSION),
        Column(name="stage", type="text", meaning="When it was asked."),
        Column(name="question", type="text", meaning="The question; the codebook has its wording."),
        Column(
            name="value",
            type="text",
            meaning="The answer as it was given.",
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
            name="video",
            type="integer",
            meaning="The video's place on the page, from 1; 0 is the reference shown apart.",
        ),
        Column(
            name="stimuli",
            type="text",
            meaning="Numbers of the stimuli it shows, from left to right, separated by spaces.",
        ),
        Column(
            name="conditions",
            type="text",
            meaning="Their conditions, from left to right, separated by spaces.",
        ),
        Column(
            name="made_from",
            type="text",
            meaning="Digest of all that the video was made from. Where it differs, participants "
            "saw another video of the same condition and segment.",
        ),
        Column(name="duration", type="number", meaning="Length of the video.", unit="s"),
        Column(
            name="watched",
            type="number",
            meaning="Share that counts as watched, in [0, 1], replays counted once.",
        ),
        Column(
            name="sent_at",
            type="moment",
            meaning="When the server first sent the video, or led the browser to the store.",
            missing="it never did, and so nothing counts as watched",
        ),
        Column(
            name="times_played",
            type="number",
            meaning="Time played in any way, replays included, over the video's length.",
        ),
        Column(name="rate", type="number", meaning="Largest playback rate seen; 1 is as recorded."),
        Column(
            name="hidden_seconds",
            type="number",
            meaning="How long it played where nobody could see it.",
            unit="s",
        ),
        Column(
            name="silent_seconds",
            type="number",
            meaning="How long it played where nobody could hear it.",
            unit="s",
        ),
        Column(
            name="stalls",
            type="integer",
            meaning="How often it waited for data while it was meant to play.",
        ),
        Column(
            name="stalled_seconds", type="number", meaning="How long it waited in all.", unit="s"
        ),
        Column(
            name="frames",
            type="integer",
            meaning="How many pictures the browser had to show.",
            missing=NOT_COUNTED,
        ),
        Column(
            name="dropped_share",
            type="number",
            meaning="Share of them that it left out, in [0, 1].",
            missing=NOT_COUNTED,
        ),
        Column(
            name="unplayable_at",
            type="moment",
            meaning="When the participant said that it does not play.",
            missing="they did not say so",
        ),
    ),
)

REFUSALS: Final = TableColumns(
    name="refusals",
    title="One request that was refused and changed nothing.",
    columns=(
        Column(
            name="participant",
            type="text",
            meaning=PARTICIPANT.meaning,
            missing="the address belonged to nobody",
        ),
        Column(
            name="study_session",
            type="integer",
            meaning=STUDY_SESSION.meaning,
            missing="the address belonged to nobody",
        ),
        Column(name="at", type="moment", meaning="When it was."),
        Column(name="kind", type="text", meaning="What was wrong, in a word."),
        Column(name="detail", type="text", meaning="What was asked for, and why it was refused."),
    ),
)

LOG: Final = TableColumns(
    name="log",
    title="One change that was made while the study ran.",
    columns=(
        Column(name="at", type="moment", meaning="When it was."),
        Column(name="event", type="text", meaning="What was done, by a name that never changes."),
        Column(
            name="detail",
            type="text",
            meaning="What there is to know beside it.",
            missing="nothing",
            free_text=True,
        ),
        Column(
            name="researcher",
            type="text",
            meaning="Who did it. It names a person.",
            missing="the server or the command line did",
            free_text=True,
        ),
        Column(
            name="reason",
            type="text",
            meaning="Why, in their words.",
            missing="none was asked for",
            free_text=True,
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
            name="recruiter_participant",
            type="text",
            meaning="The recruiter's name for the participant.",
            free_text=True,
        ),
        Column(
            name="recruiter_study",
            type="text",
            meaning="The recruiter's name for the study.",
            missing="none was given",
            free_text=True,
        ),
        Column(
            name="recruiter_session",
            type="text",
            meaning="The recruiter's name for the sitting.",
            missing="none was given, or who withdrew was promised deletion",
            free_text=True,
        ),
    ),
)
